#include "baker/solver/shoot.h"

#include <algorithm>
#include <cmath>

#include "baker/core/parallel.h"
#include "baker/solver/certified_solver.h"
#include "baker/solver/chunk_system.h"
#include "baker/solver/coarse_space.h"
#include "baker/solver/coarse_vectors.h"
#include "baker/solver/inner_solve.h"
#include "baker/solver/transport.h"

namespace luxel {

namespace {

/// Vectors of the coarse space per chunk: even light, what its neighbours send, and then what it has sent itself, as
/// long as there are fewer than so many.
constexpr std::size_t most_vectors = 8;
constexpr std::size_t most_neighbours = 3;
/// The light of neighbours is worth a second read of the row where it is a small part of the row: in rooms.
constexpr double small_part = 0.5;
/// A coarse step may take as much time as shots have taken since the last one: one of its entries costs as much as so
/// many pairs of a row (each pair is applied some ten times inside the chunk), and a patch as much as so many entries.
constexpr std::uint64_t entries_per_patch = 4;
constexpr std::uint64_t entries_per_pair = 2;
/// What the model leaves is of both signs and cancels later, which the bound does not count on. Below this share of the
/// tolerance, of unshot over all power, the light is right; what is left to do is to bring the bound down, and shots
/// alone do that better as long as what is left has both signs: less than this share of its weight is the net of its
/// chunk.
constexpr double model_until = 0.5;
constexpr double one_sided = 0.9;

class Shooter final : public CertifiedSolver {
  public:
    explicit Shooter(SolveFrame& frame);
    SolveResult run();

  private:
    [[nodiscard]] std::vector<std::vector<double>> own_numbers() const override {
        return {{static_cast<double>(pairs_since_step_), static_cast<double>(lowered_at_bytes_)}, coarse_.save()};
    }
    [[nodiscard]] ErrorSums total() const;
    [[nodiscard]] double error_bound();
    [[nodiscard]] ChunkNumber best_chunk() const;
    void shoot(ChunkNumber chunk);
    void add_vectors(const ChunkSystem& system, std::span<const Lanes> sent);
    void coarse_step();
    [[nodiscard]] bool wants_model() const;
    void lower_by_model();
    [[nodiscard]] std::vector<Lanes> solve_unshot(const ChunkSystem& system) const;
    void receive(ChunkNumber chunk, std::span<const Lanes> exchange);
    std::vector<Lanes> shoot_to_others(ChunkNumber chunk, std::span<const Lanes> sent);
    void weigh(ChunkNumber chunk);
    void weigh_all();

    std::vector<ErrorSums> sums_;  ///< per chunk
    Channels power_{0, 0, 0};      ///< sum A B, or what is emitted if that is more
    CoarseSpace coarse_;
    std::vector<std::vector<Lanes>> new_vectors_;  ///< of the chunk that shoots: their columns are still to be found
    std::uint64_t pairs_since_step_ = 0;           ///< of the rows shot since the last coarse step
    std::uint64_t lowered_at_bytes_ = 0;  ///< requested, when the weights of all chunks were last lowered together
};

Shooter::Shooter(SolveFrame& frame)
    : CertifiedSolver(frame, {2, any_size}), sums_(transport_.layout().chunk_count()), coarse_(transport_) {
    if (const auto own = take_own_numbers()) {
        pairs_since_step_ = static_cast<std::uint64_t>((*own)[0][0]);
        lowered_at_bytes_ = static_cast<std::uint64_t>((*own)[0][1]);
        coarse_.restore((*own)[1]);
    } else {
        begin_with_emission();
    }
    weigh_all();
}

void Shooter::weigh(ChunkNumber chunk) {
    ErrorSums& sums = sums_[chunk];
    sums = {};
    for (PatchNumber i = transport_.first(chunk); i < transport_.layout().first_patch[chunk + 1]; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double radiosity = frame_.emitted(i, c) + transport_.scaled_reflectance(i)[c] * irradiance_[i][c];
            sums.add(c, transport_.area_m2(i), adjoint_.weight(i)[c], unshot_[i][c], radiosity);
        }
}

void Shooter::weigh_all() {
    parallel_for(sums_.size(), 1, [&](std::size_t chunk) { weigh(static_cast<ChunkNumber>(chunk)); });
}

ErrorSums Shooter::total() const {
    ErrorSums all;
    for (const ErrorSums& sums : sums_) all.add(sums);
    return all;
}

double Shooter::error_bound() {
    const ErrorSums all = total();
    // What was sent too much may make the sum small or negative for a while.
    for (std::size_t c = 0; c < 3; ++c) power_[c] = std::max(all.power[c], frame_.emitted_power()[c]);
    return all.bound(frame_.emitted_power());
}

/// The chunk whose shot takes most from the bound per byte; the lowest number among equals.
ChunkNumber Shooter::best_chunk() const {
    ChunkNumber best = 0;
    double best_value = -1;
    for (ChunkNumber chunk = 0; chunk < sums_.size(); ++chunk) {
        double value = 0;
        for (std::size_t c = 0; c < 3; ++c)
            if (sums_[chunk].weighted[c] > 0) value = std::max(value, sums_[chunk].weighted[c] / power_[c]);
        if (value == 0) continue;
        value /= static_cast<double>(std::max<std::uint64_t>(transport_.row_bytes(chunk), 1));
        if (value > best_value) {
            best_value = value;
            best = chunk;
        }
    }
    return best;
}

std::vector<Lanes> Shooter::solve_unshot(const ChunkSystem& system) const {
    const PatchNumber first = transport_.first(system.chunk());
    std::vector<Lanes> unshot(system.size());
    for (std::size_t i = 0; i < unshot.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) unshot[i].v[c] = unshot_[first + i][c];
    InnerRest rest{unnoticed_rest(frame_.options().tolerance, power_, sums_.size())};
    for (std::size_t c = 0; c < 3; ++c)
        rest.allowed[c] = std::max(rest.allowed[c], inner_share * sums_[system.chunk()].weighted[c]);
    return solve_inside(transport_, adjoint_, system, unshot, unshot, rest);
}

/// exchange = sum over some patches j of G_ij times what j sent: adds it to irradiance, radiosity and unshot of the
/// chunk.
void Shooter::receive(ChunkNumber chunk, std::span<const Lanes> exchange) {
    for (std::size_t i = 0; i < exchange.size(); ++i) {
        const PatchNumber patch = transport_.first(chunk) + static_cast<PatchNumber>(i);
        for (std::size_t c = 0; c < 3; ++c) {
            const double received = exchange[i].v[c] / transport_.area_m2(patch);
            const double reflected = transport_.scaled_reflectance(patch)[c] * received;
            irradiance_[patch][c] += received;
            unshot_[patch][c] += reflected;
        }
    }
}

/// Sends through all blocks of the row but the diagonal one. Each task owns the chunk it sends to, so nothing is
/// written twice. Returns the adjoint gathered on the way: sum of G_ij rho'_j w_j, sum of G_ij in the spare lane.
std::vector<Lanes> Shooter::shoot_to_others(ChunkNumber chunk, std::span<const Lanes> sent) {
    const std::span<const RowBlock> row = transport_.row(chunk);
    std::vector<Lanes> gathered(sent.size());
    std::vector<std::vector<Lanes>> parts(transport_batch_blocks);
    for (std::size_t first = 0; first < row.size(); first += transport_batch_blocks) {
        const std::size_t batch = std::min(transport_batch_blocks, row.size() - first);
        parallel_for(batch, 1, [&](std::size_t k) {
            const RowBlock& target = row[first + k];
            const std::shared_ptr<const Block> loaded = transport_.load(target.index);
            const Block& block = *loaded;
            std::vector<Lanes> source(transport_.size(target.other)), exchange(source.size());
            for (std::size_t i = 0; i < source.size(); ++i) {
                const PatchNumber patch = transport_.first(target.other) + static_cast<PatchNumber>(i);
                for (std::size_t c = 0; c < 3; ++c)
                    source[i].v[c] = transport_.scaled_reflectance(patch)[c] * adjoint_.weight(patch)[c];
                source[i].v[3] = 1;
            }
            parts[k].assign(sent.size(), Lanes{});
            if (target.is_a)
                apply_both(block, sent, source, parts[k], exchange);
            else
                apply_both(block, source, sent, exchange, parts[k]);
            receive(target.other, exchange);
            weigh(target.other);
            const std::size_t first_new = coarse_.vector_count() - new_vectors_.size();
            for (std::size_t v = 0; v < new_vectors_.size(); ++v) {
                std::fill(exchange.begin(), exchange.end(), Lanes{});
                if (target.is_a)
                    scatter_columns(block, new_vectors_[v], exchange);
                else
                    gather_rows(block, new_vectors_[v], exchange);
                coarse_.set_column(first_new + v, first + k, exchange);
            }
        });
        for (std::size_t k = 0; k < batch; ++k)
            for (std::size_t i = 0; i < gathered.size(); ++i)
                for (std::size_t c = 0; c < 4; ++c) gathered[i].v[c] += parts[k][i].v[c];
    }
    return gathered;
}

void Shooter::shoot(ChunkNumber chunk) {
    const std::shared_ptr<const Block> diagonal = transport_.load_diagonal(chunk);
    const ChunkSystem system(transport_, chunk, diagonal.get());
    transport_.expect_row(chunk);  // while the light inside the chunk is found
    const std::vector<Lanes> sent = solve_unshot(system);
    for (std::size_t i = 0; i < sent.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) unshot_[transport_.first(chunk) + i][c] -= sent[i].v[c];
    std::vector<Lanes> exchange;
    system.multiply(sent, exchange);
    receive(chunk, exchange);
    add_vectors(system, sent);
    const std::vector<Lanes> gathered = shoot_to_others(chunk, sent);
    for (std::size_t k = 0; k < new_vectors_.size(); ++k)
        coarse_.finish(coarse_.vector_count() - new_vectors_.size() + k);
    new_vectors_.clear();
    if (diagonal) pairs_since_step_ += diagonal->columns.size();
    for (const RowBlock& block : transport_.row(chunk))
        pairs_since_step_ += transport_.blocks()[block.index].pair_count;
    if (adjoint_.lower(transport_, system, gathered)) {
        weigh(chunk);
    } else {
        adjoint_.certify_by_reads(transport_, frame_.emits());
        weigh_all();
    }
}

/// What the chunk adds to the coarse space with this shot.
void Shooter::add_vectors(const ChunkSystem& system, std::span<const Lanes> sent) {
    const ChunkNumber chunk = system.chunk();
    const std::size_t room = std::min(most_vectors, coarse_.room_for(chunk));
    if (sums_.size() == 1 || coarse_.count_of(chunk) >= room) return;
    std::vector<std::vector<Lanes>> light;
    if (coarse_.count_of(chunk) == 0) {
        light.push_back(even_light(transport_, system));
        const auto row_bytes = static_cast<double>(transport_.row_bytes(chunk));
        const double own_bytes =
            transport_.has_diagonal(chunk) ? static_cast<double>(transport_.diagonal_bytes(chunk)) : 0.0;
        if (row_bytes - own_bytes <= small_part * row_bytes && room > 1)
            for (std::vector<Lanes>& of_neighbour :
                 neighbour_light(transport_, system, std::min(most_neighbours, room - 1)))
                light.push_back(std::move(of_neighbour));
    }
    light.emplace_back(sent.begin(), sent.end());
    for (std::vector<Lanes>& radiosity : light) {
        for (std::size_t i = 0; i < radiosity.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                // What is emitted where nothing is reflected is sent once and never again. And where no light has come
                // yet none is guessed: a chunk may reach into a room that is closed to all light.
                const bool is_dark = irradiance_[transport_.first(chunk) + i][c] == 0;
                if (system.scale()[i].v[c] == 0 || is_dark) radiosity[i].v[c] = 0;
            }
        if (coarse_.count_of(chunk) >= room) return;
        std::vector<Lanes> own;
        system.multiply(radiosity, own);
        if (const auto vector = coarse_.add(chunk, radiosity, own)) new_vectors_.push_back(coarse_.radiosity(*vector));
    }
}

/// Sends, without a read, the light that the coarse model says is still to come.
void Shooter::coarse_step() {
    if (!wants_model()) return;
    const std::vector<Channels> levels = coarse_.levels(unshot_);
    if (levels.empty()) return;
    coarse_.send(levels, irradiance_, unshot_);
    weigh_all();
    pairs_since_step_ = 0;
}

bool Shooter::wants_model() const {
    const std::uint64_t work = coarse_.entries() + entries_per_patch * unshot_.size();
    if (coarse_.vector_count() == 0 || work > entries_per_pair * pairs_since_step_) return false;
    const ErrorSums now = total();
    Channels net{0, 0, 0};
    for (const ErrorSums& sums : sums_)
        for (std::size_t c = 0; c < 3; ++c) net[c] += std::abs(sums.weighted[c] - 2 * sums.negative[c]);
    for (std::size_t c = 0; c < 3; ++c)
        if (now.unshot[c] > model_until * frame_.options().tolerance * now.power[c] ||
            net[c] > one_sided * now.weighted[c])
            return true;
    return false;
}

/// Once all rows are known the model tells weights of all chunks at once, which shots would find one chunk at a time.
void Shooter::lower_by_model() {
    for (ChunkNumber chunk = 0; chunk < sums_.size(); ++chunk)
        if (coarse_.count_of(chunk) == 0 && transport_.row_bytes(chunk) > 0) return;
    if (lowered_at_bytes_ > 0 && transport_.requested_bytes() - lowered_at_bytes_ < frame_.total_bytes()) return;
    lowered_at_bytes_ = transport_.requested_bytes();
    if (adjoint_.lower_by(coarse_, transport_)) weigh_all();
}

SolveResult Shooter::run() {
    while (!frame_.is_done(error_bound(), *this)) {
        const ChunkNumber chunk = best_chunk();
        if (!frame_.may_read(2 * transport_.row_bytes(chunk))) break;
        shoot(chunk);
        coarse_step();
        lower_by_model();
    }
    return frame_.finish(*this);
}

}  // namespace

SolveResult solve_by_shooting(BlockSource& source, const SolveInput& input, const SolveOptions& options) {
    SolveFrame frame(source, input, options, "shoot");
    if (frame.is_trivial()) return frame.trivial_result();
    return Shooter(frame).run();
}

}  // namespace luxel
