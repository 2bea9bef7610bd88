#include "baker/solver/certificate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "baker/core/parallel.h"
#include "baker/solver/adjoint.h"
#include "baker/solver/coarse_weights.h"
#include "baker/solver/whole_read.h"
#include "formats/base/error.h"

namespace luxel {

namespace {

/// w / m is at most 1 / m times the tightest certificate: from here on the shots themselves lower it faster than reads.
constexpr double tight_margin = 0.3;
/// After so many reads any certificate is taken.
constexpr std::uint32_t patient_reads = 20;
/// A margin below this share of the weight is rounding.
constexpr double smallest_margin = 1e-9;

class Certifier {
  public:
    Certifier(Transport& transport, std::span<const std::uint8_t> emits)
        : transport_(transport),
          lit_(emits.begin(), emits.end()),
          weights_(transport.layout().patch_count()),
          best_(transport.layout().patch_count(), no_certificate),
          gathered_(transport.layout().patch_count()) {
        // D - T D = 1 - sum_j F_ij rho_j, self-exchange included: what row i loses by itself.
        for (std::size_t i = 0; i < weights_.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) weights_[i][c] = transport.self_factor(static_cast<PatchNumber>(i), c);
    }

    std::optional<std::vector<Channels>> run();
    [[nodiscard]] PatchNumber worst_patch() const { return worst_patch_; }

  private:
    /// What one read says about the rows of a chunk.
    struct ChunkFinding {
        double margin[3] = {1, 1, 1};  ///< smallest w - T w of a row that counts; -1: void
        PatchNumber worst_patch = 0;
        bool newly_lit = false;
    };

    std::vector<Lanes> source(ChunkNumber chunk) const;
    ChunkFinding inspect(ChunkNumber chunk, bool solves_rows, CoarseWeights& coarse);
    void spread_light(ChunkNumber chunk, const ChunkSystem& system, ChunkFinding& finding);
    void forget_unlit();
    bool keep_certificate(const Channels& margin);

    static constexpr Channels no_certificate{std::numeric_limits<double>::infinity(),
                                             std::numeric_limits<double>::infinity(),
                                             std::numeric_limits<double>::infinity()};
    Transport& transport_;
    std::vector<std::uint8_t> lit_;  ///< light may leave the patch
    bool lit_is_final_ = false;
    std::vector<Channels> weights_;
    std::vector<Channels> best_;  ///< the smallest certificate so far, patch by patch (property 3)
    std::vector<Lanes>
        gathered_;  ///< from other chunks: sum G rho' w; spare lane: sum G over lit ones. Then the next w.
    std::array<bool, 3> has_certificate_{};
    PatchNumber worst_patch_ = 0;
};

std::vector<Lanes> Certifier::source(ChunkNumber chunk) const {
    std::vector<Lanes> lanes = adjoint_source(transport_, weights_, chunk);
    for (std::size_t i = 0; i < lanes.size(); ++i) lanes[i].v[3] = lit_[transport_.first(chunk) + i];
    return lanes;
}

/// Marks what lit patches can see inside the chunk, until nothing changes.
void Certifier::spread_light(ChunkNumber chunk, const ChunkSystem& system, ChunkFinding& finding) {
    const PatchNumber first = transport_.first(chunk);
    std::vector<Lanes> x(system.size()), y(system.size());
    for (bool changed = true; changed;) {
        changed = false;
        for (std::size_t i = 0; i < x.size(); ++i) x[i].v[3] = lit_[first + i];
        if (system.has_pairs()) system.multiply(x, y);
        for (std::size_t i = 0; i < x.size(); ++i) {
            const PatchNumber patch = first + static_cast<PatchNumber>(i);
            const Channels& reflect = transport_.scaled_reflectance(patch);
            const bool reflects = reflect[0] > 0 || reflect[1] > 0 || reflect[2] > 0;
            if (lit_[patch] || !reflects || !(gathered_[patch].v[3] + y[i].v[3] > 0)) continue;
            lit_[patch] = 1;
            changed = finding.newly_lit = true;
        }
    }
}

Certifier::ChunkFinding Certifier::inspect(ChunkNumber chunk, bool solves_rows, CoarseWeights& coarse) {
    ChunkFinding finding;
    const PatchNumber first = transport_.first(chunk);
    const std::size_t count = transport_.size(chunk);
    const std::shared_ptr<const Block> diagonal = transport_.load_diagonal(chunk);
    const ChunkSystem system(transport_, chunk, diagonal.get());
    std::vector<Lanes> w(count);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c) w[i].v[c] = weights_[first + i][c];
    const std::vector<Lanes> inside = apply_adjoint_inside(transport_, system, w);
    coarse.set_chunk(chunk, w, inside);
    double worst = 1;
    for (std::size_t i = 0; i < count; ++i) {
        const PatchNumber patch = first + static_cast<PatchNumber>(i);
        if (lit_is_final_ && !lit_[patch]) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const double received = inside[i].v[c] + gathered_[patch].v[c] / transport_.area_m2(patch);
            double rest = w[i].v[c] - received;
            if (!(rest > smallest_margin * w[i].v[c])) rest = -1;
            finding.margin[c] = std::min(finding.margin[c], rest);
            if (rest < worst) {
                worst = rest;
                finding.worst_patch = patch;
            }
        }
    }
    if (!lit_is_final_) spread_light(chunk, system, finding);
    const std::span<Lanes> gathered(gathered_.data() + first, count);
    if (solves_rows) solve_adjoint_rows(transport_, system, gathered, {.absolute = 0.01}, w);
    std::copy(w.begin(), w.end(), gathered.begin());
    return finding;
}

void Certifier::forget_unlit() {
    for (std::size_t i = 0; i < lit_.size(); ++i) {
        if (lit_[i]) continue;
        transport_.forget(static_cast<PatchNumber>(i));
        weights_[i] = best_[i] = {1, 1, 1};
    }
}

/// Makes a certificate of the current weights in each channel where the margin allows. True if every channel has one.
bool Certifier::keep_certificate(const Channels& margin) {
    bool complete = true;
    for (std::size_t c = 0; c < 3; ++c) {
        if (margin[c] > 0)
            for (std::size_t i = 0; i < weights_.size(); ++i)
                if (!lit_is_final_ || lit_[i])
                    best_[i][c] = std::min(best_[i][c], weights_[i][c] / margin[c] * (1 + 1e-10));
        has_certificate_[c] = has_certificate_[c] || margin[c] > 0;
        complete = complete && has_certificate_[c];
    }
    return complete;
}

std::optional<std::vector<Channels>> Certifier::run() {
    const ChunkNumber chunk_count = transport_.layout().chunk_count();
    for (std::uint32_t read = 0; read < max_certificate_reads; ++read) {
        CoarseWeights coarse(transport_);
        gathered_ = exchange_between_chunks(
            transport_, [this](ChunkNumber chunk) { return source(chunk); },
            [&](std::size_t block, std::span<const Lanes> x_a, std::span<const Lanes> y_a) {
                coarse.set_coupling(block, x_a, y_a);
            });
        const bool solves_rows = read % 2 == 0;
        std::vector<ChunkFinding> findings(chunk_count);
        parallel_for(chunk_count, 1, [&](std::size_t chunk) {
            findings[chunk] = inspect(static_cast<ChunkNumber>(chunk), solves_rows, coarse);
        });
        Channels margin{1, 1, 1};
        bool newly_lit = false;
        for (const ChunkFinding& finding : findings) {
            const double before = *std::min_element(margin.begin(), margin.end());
            for (std::size_t c = 0; c < 3; ++c) margin[c] = std::min(margin[c], finding.margin[c]);
            if (*std::min_element(margin.begin(), margin.end()) < before) worst_patch_ = finding.worst_patch;
            newly_lit = newly_lit || finding.newly_lit;
        }
        const bool is_complete = keep_certificate(margin);
        const bool is_tight = *std::min_element(margin.begin(), margin.end()) >= tight_margin;
        if (is_tight || (is_complete && read >= patient_reads)) return std::move(best_);
        if (solves_rows) {
            for (std::size_t i = 0; i < weights_.size(); ++i)
                for (std::size_t c = 0; c < 3; ++c) weights_[i][c] = gathered_[i].v[c];
        } else {
            coarse.scale(weights_);
        }
        if (!newly_lit && !lit_is_final_) {
            lit_is_final_ = true;
            forget_unlit();
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<std::vector<Channels>> certificate_by_reads(Transport& transport, std::span<const std::uint8_t> emits,
                                                          bool must_exist) {
    Certifier certifier(transport, emits);
    auto weights = certifier.run();
    if (weights || !must_exist) return weights;
    throw Error(ErrorCode::bad_input, "solve, patch " + std::to_string(certifier.worst_patch()),
                "the light never ends: it reaches surfaces that reflect all of it (reflectance 1) and has no way out",
                "lower the reflectance of a surface below 1, or open the scene");
}

}  // namespace luxel
