#include "baker/output/seam_join.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "baker/core/disjoint_sets.h"
#include "baker/core/parallel.h"
#include "formats/base/error.h"

namespace luxel {
namespace {

/// Against the points of a texel's length of seam, which weigh 1: a jump that covered texels alone must close keeps
/// some hundredths of itself. Filled ones give in first.
constexpr float covered_stiffness = 1.0f / 64, filled_stiffness = 1.0f / 2048;
/// Of the residual, relative, where the solve ends: what is left of a jump is more than that.
constexpr double tolerance = 1e-3;
/// The condition is a few thousand at most, whatever the size, so this is hardly ever met.
constexpr int most_iterations = 200;
/// Rounds of fixing texels at their bounds. What the last one leaves outside is put onto its bound.
constexpr int bound_rounds = 4;

double read(const SeamTap& tap, std::span<const Rgb> values, int channel) {
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k)
        sum += static_cast<double>(tap.weight[k]) * static_cast<double>(values[tap.texel[k]][channel]);
    return sum;
}

template <class Visit>
void for_texels(const SeamSample& sample, const Visit& visit) {
    for (const SeamTap* tap : {&sample.a, &sample.b})
        for (std::size_t k = 0; k < 4; ++k)
            if (tap->weight[k] > 0) visit(tap->texel[k], tap == &sample.a ? tap->weight[k] : -tap->weight[k]);
}

/// Texels that hang together over points, and the points, as runs of two lists.
struct TexelSetRun {
    std::size_t first_texel, end_texel, first_sample, end_sample;
};

struct TexelSets {
    std::vector<std::uint32_t> texels, samples;  ///< grouped by set, ascending inside one
    std::vector<std::uint32_t> place;            ///< per texel: its place in its set
    std::vector<TexelSetRun> runs;
};

TexelSets find_sets(const SeamSamples& all, const std::vector<std::uint32_t>& joined) {
    const auto texel_count = static_cast<std::uint32_t>(all.texels.size());
    DisjointSets sets(texel_count);
    std::vector<bool> is_used(texel_count, false);
    for (const std::uint32_t s : joined) {
        std::uint32_t first = none;
        for_texels(all.samples[s], [&](std::uint32_t texel, float) {
            if (first == none) first = texel;
            sets.unite(first, texel);
            is_used[texel] = true;
        });
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> texels, samples;  // (set, texel or sample)
    for (std::uint32_t t = 0; t < texel_count; ++t)
        if (is_used[t]) texels.emplace_back(sets.find(t), t);
    for (const std::uint32_t s : joined) {
        std::uint32_t set = none;
        for_texels(all.samples[s], [&](std::uint32_t texel, float) { set = sets.find(texel); });
        samples.emplace_back(set, s);
    }
    std::sort(texels.begin(), texels.end());
    std::sort(samples.begin(), samples.end());
    TexelSets found;
    found.place.assign(texel_count, none);
    for (std::size_t t = 0, s = 0; t < texels.size();) {
        TexelSetRun run{t, t, s, s};
        const std::uint32_t set = texels[t].first;
        for (; t < texels.size() && texels[t].first == set; ++t)
            found.place[texels[t].second] = static_cast<std::uint32_t>(t - run.first_texel);
        while (s < samples.size() && samples[s].first == set) ++s;
        run.end_texel = t;
        run.end_sample = s;
        found.runs.push_back(run);
    }
    for (const auto& [set, texel] : texels) found.texels.push_back(texel);
    for (const auto& [set, sample] : samples) found.samples.push_back(sample);
    return found;
}

/// One set, its three channels side by side: what costs time is finding the texels, which they share. Vectors are
/// floats, sums over a whole vector doubles.
class SetSolver {
  public:
    SetSolver(const SeamSamples& all, const TexelSets& sets, const TexelSetRun& run,
              std::span<const SeamTexelKind> kinds, std::span<Rgb> values)
        : all_(all),
          place_(sets.place),
          texels_(std::span(sets.texels).subspan(run.first_texel, run.end_texel - run.first_texel)),
          samples_(std::span(sets.samples).subspan(run.first_sample, run.end_sample - run.first_sample)),
          values_(values) {
        for (const std::uint32_t texel : texels_)
            stiffness_.push_back(kinds[texel] == SeamTexelKind::covered ? covered_stiffness : filled_stiffness);
        diagonal_ = stiffness_;
        // A texel that both sides read appears twice in a row: an estimate is enough for a preconditioner.
        for (const std::uint32_t s : samples_)
            for_texels(all_.samples[s], [&](std::uint32_t texel, float weight) {
                diagonal_[place_[texel]] += all_.samples[s].length * weight * weight;
            });
    }

    void solve() {
        find_bounds();
        change_.assign(texels_.size(), Rgb(0, 0, 0));
        is_free_.assign(texels_.size(), {true, true, true});
        std::optional<Vec3d> enough;
        for (int round = 0; round < bound_rounds; ++round) {
            descend(enough);
            if (!put_into_bounds()) break;
        }
        for (std::size_t t = 0; t < texels_.size(); ++t)
            for (int c = 0; c < 3; ++c) start(t)[c] = std::clamp(start(t)[c] + change_[t][c], low_[t][c], high_[t][c]);
    }

  private:
    using Vector = std::vector<Rgb>;
    /// Before the join; the result is put there at the end.
    [[nodiscard]] Rgb& start(std::size_t t) const { return values_[texels_[t]]; }

    void find_bounds() {
        for (std::size_t t = 0; t < texels_.size(); ++t) low_.push_back(start(t));
        high_ = low_;
        const auto spread = [](Rgb& low, Rgb& high, const Rgb& from, const Rgb& to) {
            for (int c = 0; c < 3; ++c) {
                low[c] = std::min(low[c], from[c]);
                high[c] = std::max(high[c], to[c]);
            }
        };
        for (const std::uint32_t s : samples_) {
            Rgb low = values_[all_.samples[s].a.texel[0]], high = low;
            for_texels(all_.samples[s],
                       [&](std::uint32_t texel, float) { spread(low, high, values_[texel], values_[texel]); });
            for_texels(all_.samples[s], [&](std::uint32_t texel, float) {
                spread(low_[place_[texel]], high_[place_[texel]], low, high);
            });
        }
    }

    /// Fixes what has left its bounds, on them. False if nothing has.
    bool put_into_bounds() {
        bool any = false;
        for (std::size_t t = 0; t < texels_.size(); ++t)
            for (int c = 0; c < 3; ++c) {
                const float value = start(t)[c] + change_[t][c];
                if (!is_free_[t][static_cast<std::size_t>(c)] || (value >= low_[t][c] && value <= high_[t][c]))
                    continue;
                change_[t][c] = std::clamp(value, low_[t][c], high_[t][c]) - start(t)[c];
                is_free_[t][static_cast<std::size_t>(c)] = false;
                any = true;
            }
        return any;
    }

    /// out = (transposed points * lengths * points) in; in(t) is the vector's element.
    template <class In>
    void apply_points(const In& in, Vector& out) const {
        out.assign(texels_.size(), Rgb(0, 0, 0));
        for (const std::uint32_t s : samples_) {
            const SeamSample& sample = all_.samples[s];
            Vec3d jump(0, 0, 0);  // two sides that are nearly the same
            for_texels(sample, [&](std::uint32_t t, float weight) {
                jump += to_double(in(place_[t])) * static_cast<double>(weight);
            });
            const Rgb pull = to_float(jump) * sample.length;
            for_texels(sample, [&](std::uint32_t t, float weight) { out[place_[t]] += pull * weight; });
        }
    }
    /// What is on its bound takes no part.
    void keep_free(Vector& vector) const {
        for (std::size_t t = 0; t < vector.size(); ++t)
            for (std::size_t c = 0; c < 3; ++c)
                if (!is_free_[t][c]) vector[t][static_cast<int>(c)] = 0;
    }
    static Vec3d dot(const Vector& a, const Vector& b) {
        Vec3d sum(0, 0, 0);
        for (std::size_t t = 0; t < a.size(); ++t) sum += to_double(a[t]) * to_double(b[t]);
        return sum;
    }
    void precondition() {
        for (std::size_t t = 0; t < residual_.size(); ++t) scaled_[t] = residual_[t] / diagonal_[t];
    }

    /// Conjugate gradients from change_ over what is free, until the residual is `enough`: found by the first call.
    void descend(std::optional<Vec3d>& enough) {
        apply_points([&](std::uint32_t t) { return start(t) + change_[t]; }, residual_);
        for (std::size_t t = 0; t < texels_.size(); ++t) residual_[t] = -residual_[t] - change_[t] * stiffness_[t];
        keep_free(residual_);
        scaled_.resize(texels_.size());
        precondition();
        way_ = scaled_;
        Vec3d power = dot(residual_, scaled_);
        if (!enough) enough = power * (tolerance * tolerance);
        for (int k = 0; k < most_iterations && exceeds(power, *enough); ++k) {
            apply_points([&](std::uint32_t t) { return way_[t]; }, image_);
            for (std::size_t t = 0; t < way_.size(); ++t) image_[t] += way_[t] * stiffness_[t];
            keep_free(image_);
            const Rgb step = share(power, dot(way_, image_), power, *enough);
            for (std::size_t t = 0; t < way_.size(); ++t) {
                change_[t] += way_[t] * step;
                residual_[t] -= image_[t] * step;
            }
            precondition();
            const Vec3d next = dot(residual_, scaled_);
            const Rgb keep = share(next, power, power, *enough);
            for (std::size_t t = 0; t < way_.size(); ++t) way_[t] = scaled_[t] + way_[t] * keep;
            power = next;
        }
    }
    static bool exceeds(const Vec3d& power, const Vec3d& enough) {
        return power.x > enough.x || power.y > enough.y || power.z > enough.z;
    }
    /// a / b for channels that are still in work, 0 for those that are done.
    static Rgb share(const Vec3d& a, const Vec3d& b, const Vec3d& power, const Vec3d& enough) {
        Rgb result(0, 0, 0);
        for (int c = 0; c < 3; ++c)
            if (power[c] > enough[c] && b[c] > 0) result[c] = static_cast<float>(a[c] / b[c]);
        return result;
    }

    const SeamSamples& all_;
    const std::vector<std::uint32_t>& place_;
    const std::span<const std::uint32_t> texels_, samples_;
    const std::span<Rgb> values_;
    std::vector<float> stiffness_, diagonal_;
    Vector low_, high_, change_, residual_, scaled_, way_, image_;
    std::vector<std::array<bool, 3>> is_free_;
};

std::vector<std::uint32_t> joined_samples(const SeamSamples& all, std::span<const SeamTexelKind> kinds) {
    std::vector<std::uint32_t> joined;
    for (std::uint32_t s = 0; s < all.samples.size(); ++s) {
        bool whole = true;
        for_texels(all.samples[s],
                   [&](std::uint32_t texel, float) { whole = whole && kinds[texel] != SeamTexelKind::empty; });
        if (whole) joined.push_back(s);
    }
    return joined;
}

double relative_jump(const SeamSamples& all, const std::vector<std::uint32_t>& joined, std::span<const Rgb> values) {
    double jump = 0, light = 0;
    for (const std::uint32_t s : joined) {
        const SeamSample& sample = all.samples[s];
        const auto luminance_of = [&](const SeamTap& tap) {
            return 0.2126 * read(tap, values, 0) + 0.7152 * read(tap, values, 1) + 0.0722 * read(tap, values, 2);
        };
        const double a = luminance_of(sample.a), b = luminance_of(sample.b);
        jump += static_cast<double>(sample.length) * std::abs(a - b);
        light += static_cast<double>(sample.length) * (a + b) / 2;
    }
    return light > 0 ? jump / light : 0;
}

}  // namespace

SeamJump join_seams(const SeamSamples& samples, std::span<const SeamTexelKind> kinds, std::span<Rgb> values) {
    if (kinds.size() != samples.texels.size() || values.size() != kinds.size() || samples.samples.size() >= none ||
        kinds.size() >= none)
        throw Error(ErrorCode::internal, "join seams",
                    "the number of values is not that of the texels, or beyond 2^32 - 2");
    const std::vector<std::uint32_t> joined = joined_samples(samples, kinds);
    SeamJump jump;
    for (const std::uint32_t s : joined) jump.length_texels += static_cast<double>(samples.samples[s].length);
    jump.before = relative_jump(samples, joined, values);
    const std::vector<Rgb> start(values.begin(), values.end());
    const TexelSets sets = find_sets(samples, joined);
    parallel_for(sets.runs.size(), 1,
                 [&](std::size_t set) { SetSolver(samples, sets, sets.runs[set], kinds, values).solve(); });
    jump.after = relative_jump(samples, joined, values);
    for (std::size_t t = 0; t < start.size(); ++t) jump.texels += values[t] != start[t];
    return jump;
}

std::uint64_t seam_join_bytes(std::span<const Seam> seams) {
    // A point while it is numbered (RawSample and eight sort keys), then as a sample and in the lists of the sets.
    constexpr std::uint64_t bytes_per_point = 168 + sizeof(SeamSample) + 16;
    // A texel: its place, value before and after, kind, set and place in it, and the vectors of the solve.
    constexpr std::uint64_t bytes_per_texel = sizeof(SeamTexel) + 2 * sizeof(Rgb) + 1 + 20 + 8 + 7 * sizeof(Rgb) + 3;
    std::uint64_t bytes = 0;
    for (const Seam& seam : seams) {
        const std::uint64_t points = seam_point_count({&seam, 1});
        // Each side reads four at its first point, and at each next one, half a texel on, no more than 1.5 new ones on
        // average.
        bytes += points * bytes_per_point + (points ? 5 + 3 * points : 0) * bytes_per_texel;
    }
    return bytes;
}

}  // namespace luxel
