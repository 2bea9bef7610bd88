#include "baker/solver/shoot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "baker/core/parallel.h"
#include "baker/solver/adjoint.h"
#include "baker/solver/chunk_system.h"
#include "baker/solver/coarse.h"
#include "baker/solver/inner_solve.h"
#include "baker/solver/solve_frame.h"
#include "baker/solver/transport.h"
#include "baker/solver/whole_read.h"

namespace luxel {

namespace {

/// Shots of so many whole reads that lower the bound by less than this factor are followed by a coarse step.
constexpr double coarse_window_reads = 1.5;
constexpr double coarse_if_slower_than = 10;

class Shooter final : public SolverVectors {
  public:
    explicit Shooter(SolveFrame& frame);
    SolveResult run();
    [[nodiscard]] std::span<const Channels> irradiance() const override { return irradiance_; }
    [[nodiscard]] std::span<const Channels> unshot() const override { return unshot_; }
    [[nodiscard]] std::vector<std::vector<double>> save() const override {
        return {adjoint_.save(transport_), to_numbers(irradiance()), to_numbers(unshot()), {window_start_bound_, static_cast<double>(window_start_bytes_), coarse_ ? 1.0 : 0.0}};
    }

  private:
    [[nodiscard]] std::array<std::size_t, 4> sizes() const {
        const std::size_t count = transport_.layout().patch_count();
        return {1 + 3 * count, 3 * count, 3 * count, 3};
    }
    [[nodiscard]] double error_bound();
    [[nodiscard]] ChunkNumber best_chunk() const;
    [[nodiscard]] bool is_slow(double bound);
    void shoot(ChunkNumber chunk);
    void coarse_step();
    void read_coarse_system();
    [[nodiscard]] std::vector<Lanes> solve_unshot(const ChunkSystem& system) const;
    void take_from_unshot(ChunkNumber chunk, std::span<Lanes> sent);
    void receive(ChunkNumber chunk, std::span<const Lanes> exchange);
    std::vector<Lanes> shoot_to_others(ChunkNumber chunk, std::span<const Lanes> sent);
    void weigh(ChunkNumber chunk);
    void weigh_all();

    SolveFrame& frame_;
    Transport& transport_;
    const std::vector<std::vector<double>>* saved_;
    Adjoint adjoint_;
    std::vector<Channels> unshot_, irradiance_;  ///< U; H without the patch's own part
    std::vector<ErrorSums> sums_;  ///< per chunk
    Channels power_{0, 0, 0};             ///< sum A B
    std::optional<CoarseSystem> coarse_;  ///< and the shapes it is made for; only if shots alone are slow
    std::vector<Channels> shape_;
    std::uint64_t window_start_bytes_ = 0;
    double window_start_bound_ = std::numeric_limits<double>::infinity();
};

Shooter::Shooter(SolveFrame& frame)
    : frame_(frame),
      transport_(frame.transport()),
      saved_(frame.resumed(sizes())),
      adjoint_(Adjoint::begin(transport_, frame.emits(), saved_)),
      unshot_(transport_.layout().patch_count(), {0, 0, 0}),
      irradiance_(unshot_.size(), {0, 0, 0}),
      sums_(transport_.layout().chunk_count()) {
    for (ChunkNumber chunk = 0; chunk < sums_.size(); ++chunk) {
        // A chunk that sees nothing has nothing to send to.
        if (transport_.row_bytes(chunk) == 0) continue;
        for (PatchNumber i = transport_.first(chunk); i < transport_.layout().first_patch[chunk + 1]; ++i)
            for (std::size_t c = 0; c < 3; ++c) unshot_[i][c] = frame_.emitted(i, c);
    }
    if (saved_) {
        from_numbers((*saved_)[1], irradiance_);
        from_numbers((*saved_)[2], unshot_);
        window_start_bound_ = (*saved_)[3][0];
        window_start_bytes_ = static_cast<std::uint64_t>((*saved_)[3][1]);
    }
    weigh_all();
}

void Shooter::weigh(ChunkNumber chunk) {
    ErrorSums& sums = sums_[chunk];
    sums = {};
    for (PatchNumber i = transport_.first(chunk); i < transport_.layout().first_patch[chunk + 1]; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double radiosity = frame_.emitted(i, c) + transport_.scaled_reflectance(i)[c] * irradiance_[i][c];
            sums.add(c, transport_.area_m2(i) * adjoint_.weight(i)[c], unshot_[i][c], transport_.area_m2(i) * radiosity);
        }
}

void Shooter::weigh_all() {
    parallel_for(sums_.size(), 1, [&](std::size_t chunk) { weigh(static_cast<ChunkNumber>(chunk)); });
}

double Shooter::error_bound() {
    ErrorSums all;
    for (const ErrorSums& sums : sums_)
        for (std::size_t c = 0; c < 3; ++c) {
            all.weighted[c] += sums.weighted[c];
            all.negative[c] += sums.negative[c];
            all.power[c] += sums.power[c];
        }
    power_ = all.power;
    return all.bound();
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
            Block block;
            transport_.load(target.index, block);
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
        });
        for (std::size_t k = 0; k < batch; ++k)
            for (std::size_t i = 0; i < gathered.size(); ++i)
                for (std::size_t c = 0; c < 4; ++c) gathered[i].v[c] += parts[k][i].v[c];
    }
    return gathered;
}

/// Limits what is about to be sent so that all that was ever sent stays nonnegative, and radiosity with it.
void Shooter::take_from_unshot(ChunkNumber chunk, std::span<Lanes> sent) {
    for (std::size_t i = 0; i < sent.size(); ++i) {
        const PatchNumber patch = transport_.first(chunk) + static_cast<PatchNumber>(i);
        for (std::size_t c = 0; c < 3; ++c) {
            const double reflect = transport_.scaled_reflectance(patch)[c];
            const double sent_before = frame_.emitted(patch, c) + reflect * irradiance_[patch][c] - unshot_[patch][c];
            sent[i].v[c] = std::max(sent[i].v[c], std::min(0.0, -sent_before));
            unshot_[patch][c] -= sent[i].v[c];
        }
    }
}

void Shooter::shoot(ChunkNumber chunk) {
    Block diagonal;
    const bool has_pairs = transport_.load_diagonal(chunk, diagonal);
    const ChunkSystem system(transport_, chunk, has_pairs ? &diagonal : nullptr);
    std::vector<Lanes> sent = solve_unshot(system);
    take_from_unshot(chunk, sent);
    std::vector<Lanes> exchange;
    system.multiply(sent, exchange);
    receive(chunk, exchange);
    const std::vector<Lanes> gathered = shoot_to_others(chunk, sent);
    if (adjoint_.lower(transport_, system, gathered)) {
        weigh(chunk);
    } else {
        adjoint_.certify_by_reads(transport_, frame_.emits());
        weigh_all();
    }
}

/// True at the end of a window of shots that brought too little.
bool Shooter::is_slow(double bound) {
    const auto bytes = static_cast<double>(transport_.requested_bytes() - window_start_bytes_);
    if (bytes < coarse_window_reads * static_cast<double>(frame_.total_bytes())) return false;
    const bool slow = bound * coarse_if_slower_than > window_start_bound_;
    window_start_bytes_ = transport_.requested_bytes();
    window_start_bound_ = bound;
    return slow && sums_.size() > 1;
}

/// One read, for the first coarse step only: the model of exchange between chunks. The shape of the irradiance inside a
/// chunk is that of even light from outside together with all that the chunk itself makes of it, which is how light
/// that stays for long looks like.
void Shooter::read_coarse_system() {
    CoarseSystem& coarse = coarse_.emplace(transport_);
    shape_.assign(unshot_.size(), {0, 0, 0});
    parallel_for(sums_.size(), 1, [&](std::size_t k) {
        const auto chunk = static_cast<ChunkNumber>(k);
        Block diagonal;
        const bool has_pairs = transport_.load_diagonal(chunk, diagonal);
        const ChunkSystem system(transport_, chunk, has_pairs ? &diagonal : nullptr);
        std::vector<Lanes> shape(system.size(), Lanes{{1, 1, 1, 0}});
        solve_adjoint_rows(transport_, system, std::vector<Lanes>(system.size()), {.relative = 0.01}, shape);
        coarse.set_chunk(chunk, shape, apply_adjoint_inside(transport_, system, shape));
        for (std::size_t i = 0; i < shape.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) shape_[transport_.first(chunk) + i][c] = shape[i].v[c];
    });
    exchange_between_chunks(
        transport_, [this](ChunkNumber chunk) { return adjoint_source(transport_, shape_, chunk); },
        [&](std::size_t block, std::span<const Lanes> x_a, std::span<const Lanes> y_a) {
            coarse.set_coupling(block, x_a, y_a);
        });
}

/// Sends, from all chunks in one read, the light that the coarse model says is still to come. Like any other light that
/// is sent it is accounted for exactly, so a poor model costs a read and nothing else.
void Shooter::coarse_step() {
    if (!coarse_) read_coarse_system();
    std::vector<Channels> level(sums_.size(), {0, 0, 0});  // irradiance per chunk, in units of its shape
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<double> unshot_power(sums_.size(), 0.0);
        for (ChunkNumber chunk = 0; chunk < sums_.size(); ++chunk)
            for (PatchNumber i = transport_.first(chunk); i < transport_.layout().first_patch[chunk + 1]; ++i)
                unshot_power[chunk] += transport_.area_m2(i) * shape_[i][c] * unshot_[i][c];
        const std::vector<double> solution = coarse_->solve(c, unshot_power);
        for (std::size_t chunk = 0; chunk < solution.size(); ++chunk) level[chunk][c] = solution[chunk];
    }
    std::vector<Lanes> sent(unshot_.size());
    parallel_for(sums_.size(), 1, [&](std::size_t k) {
        const auto chunk = static_cast<ChunkNumber>(k);
        const PatchNumber first = transport_.first(chunk);
        const std::span<Lanes> lanes(sent.data() + first, transport_.size(chunk));
        for (std::size_t i = 0; i < lanes.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                // Where no light has come yet none is guessed: a chunk may reach into a room that is closed to all light.
                if (irradiance_[first + i][c] == 0) continue;
                lanes[i].v[c] = transport_.scaled_reflectance(first + static_cast<PatchNumber>(i))[c] *
                                shape_[first + i][c] * level[k][c];
            }
        take_from_unshot(chunk, lanes);
    });
    const auto sent_by = [&](ChunkNumber chunk) {
        const auto begin = sent.begin() + transport_.first(chunk);
        return std::vector<Lanes>(begin, begin + transport_.size(chunk));
    };
    const std::vector<Lanes> exchange = exchange_between_chunks(transport_, sent_by, {});
    parallel_for(sums_.size(), 1, [&](std::size_t k) {
        const auto chunk = static_cast<ChunkNumber>(k);
        Block diagonal;
        const bool has_pairs = transport_.load_diagonal(chunk, diagonal);
        const ChunkSystem system(transport_, chunk, has_pairs ? &diagonal : nullptr);
        std::vector<Lanes> inside;
        system.multiply(sent_by(chunk), inside);
        receive(chunk, inside);
        receive(chunk, std::span<const Lanes>(exchange).subspan(transport_.first(chunk), inside.size()));
        weigh(chunk);
    });
}

SolveResult Shooter::run() {
    for (;;) {
        const double bound = error_bound();
        if (frame_.is_done(bound, *this)) break;
        if (is_slow(bound)) {
            if (!frame_.may_read(2 * frame_.total_bytes())) break;
            coarse_step();
            window_start_bytes_ = transport_.requested_bytes();
            continue;
        }
        const ChunkNumber chunk = best_chunk();
        if (!frame_.may_read(transport_.row_bytes(chunk))) break;
        shoot(chunk);
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
