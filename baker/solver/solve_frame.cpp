#include "baker/solver/solve_frame.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "baker/core/parallel.h"
#include "formats/base/error.h"

namespace luxel {
namespace {

/// A power of two near 1 / largest emission per channel; 1 where there is none.
Channels emission_scale(const SolveInput& input, std::array<bool, 3>& is_lit) {
    Channels largest{0, 0, 0}, scale{1, 1, 1};
    for (std::size_t i = 0; i < input.emission.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double emission = input.emission[i][c];
            if (!(emission >= 0 && std::isfinite(emission)))
                throw Error(ErrorCode::bad_input, "solve, patch " + std::to_string(i),
                            "emission " + std::to_string(emission) + " is not a finite number of at least 0");
            largest[c] = std::max(largest[c], emission);
        }
    for (std::size_t c = 0; c < 3; ++c) {
        is_lit[c] = largest[c] > 0;
        // 2^1000 is as far as a scale can go: denormal emissions stay small.
        if (is_lit[c]) scale[c] = std::ldexp(1.0, std::clamp(-std::ilogb(largest[c]), -1000, 1000));
    }
    return scale;
}

/// Light that a patch sends to itself only never reaches the bound's sums.
void refuse_endless_patches(const BlockSource& source, const SolveInput& input) {
    for (std::size_t i = 0; i < input.emission.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double returned = static_cast<double>(input.reflectance[i][static_cast<int>(c)]) *
                                    source.diagonal_m2()[i] / source.area_m2()[i];
            if (input.emission[i][c] > 0 && returned > 1 - 1e-12)
                throw Error(ErrorCode::bad_input, "solve, patch " + std::to_string(i),
                            "the light never ends: the patch emits, reflects everything and sees only itself",
                            "lower its reflectance below 1");
        }
}

const SolveInput& checked(const BlockSource& source, const SolveInput& input) {
    const std::size_t count = source.layout().patch_count();
    if (input.emission.size() != count || input.reflectance.size() != count)
        throw Error(ErrorCode::internal, "solve", "reflectance and emission need one entry per patch");
    flush_denormals();
    return input;
}

}  // namespace

SolveFrame::SolveFrame(BlockSource& source, const SolveInput& input, const SolveOptions& options, std::string solver)
    : source_(source),
      input_(checked(source, input)),
      options_(options),
      scale_(emission_scale(input, is_lit_)),
      transport_(source, input.reflectance, is_lit_),
      total_bytes_(source.total_bytes()),
      disk_bytes_before_(source.bytes_read()),
      resumed_bytes_(options.resume ? options.resume->bytes_read : 0) {
    result_.solver = std::move(solver);
    if (options.resume) {
        for (const SolveStep& step : options.resume->history) history_.add(step);
        transport_.resume_at(options.resume->requested_bytes);
    }
    const std::size_t count = input.emission.size();
    bool reflects = false;
    emits_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        emits_[i] = input.emission[i][0] > 0 || input.emission[i][1] > 0 || input.emission[i][2] > 0;
        for (std::size_t c = 0; c < 3; ++c)
            emitted_power_[c] +=
                transport_.area_m2(static_cast<PatchNumber>(i)) * emitted(static_cast<PatchNumber>(i), c);
        for (std::size_t c = 0; c < 3; ++c)
            reflects = reflects || transport_.scaled_reflectance(static_cast<PatchNumber>(i))[c] > 0;
    }
    trivial_ = !reflects;
    if (reflects) refuse_endless_patches(source, input);
}

SolveResult SolveFrame::trivial_result() const {
    SolveResult result = result_;
    result.radiosity.assign(input_.emission.begin(), input_.emission.end());
    result.unshot = result.radiosity;
    result.irradiance.assign(input_.emission.size(), {0, 0, 0});
    result.converged = true;
    result.history.push_back({0, 0.0});
    return result;
}

double SolveFrame::emitted(PatchNumber patch, std::size_t channel) const {
    const double emission = input_.emission[patch][channel];
    return emission > 0 ? emission * scale_[channel] / transport_.self_factor(patch, channel) : 0.0;
}

class SolveFrame::View final : public SolveView {
  public:
    View(const SolveFrame& frame, double error_bound, const SolverVectors& solver)
        : frame_(frame), error_bound_(error_bound), solver_(solver) {}
    [[nodiscard]] std::uint64_t bytes_read() const override { return frame_.bytes_read(); }
    [[nodiscard]] double error_bound() const override { return error_bound_; }
    [[nodiscard]] std::vector<Channels> irradiance(bool ambient) const override {
        return frame_.scaled_irradiance(solver_.irradiance(),
                                        ambient ? frame_.ambient(solver_.unshot()) : Channels{0, 0, 0});
    }
    [[nodiscard]] SolveState state() const override {
        return {frame_.result_.solver, frame_.bytes_read(), frame_.transport_.requested_bytes(),
                frame_.history_.steps(), solver_.save()};
    }

  private:
    const SolveFrame& frame_;
    double error_bound_;
    const SolverVectors& solver_;
};

std::uint64_t SolveFrame::bytes_read() const { return source_.bytes_read() - disk_bytes_before_ + resumed_bytes_; }

std::optional<std::vector<std::vector<double>>> SolveFrame::resumed(std::span<const std::size_t> sizes) const {
    if (!options_.resume) return std::nullopt;
    SolveState& state = *options_.resume;
    bool fits = state.solver == result_.solver && state.numbers.size() == sizes.size();
    for (std::size_t k = 0; fits && k < sizes.size(); ++k)
        fits = sizes[k] == any_size || state.numbers[k].size() == sizes[k];
    if (!fits)
        throw Error(ErrorCode::internal, "solve", "the state to go on from is not one of this solver and matrix");
    return std::exchange(state.numbers, {});
}

bool SolveFrame::note(double error_bound, const SolverVectors& solver) {
    history_.add({bytes_read(), error_bound});
    if (total_bytes_ > 0) result_.reads = static_cast<double>(bytes_read()) / static_cast<double>(total_bytes_);
    result_.error_bound = error_bound;
    if (options_.step && !options_.step(View(*this, error_bound, solver))) stopped_ = true;
    return stopped_;
}

bool SolveFrame::is_done(double error_bound, const SolverVectors& solver) {
    note(error_bound, solver);
    result_.converged = error_bound <= options_.tolerance;
    return result_.converged || stopped_;
}

bool SolveFrame::may_read(std::uint64_t bytes) const {
    return static_cast<double>(transport_.requested_bytes() + bytes) <=
           static_cast<double>(options_.max_reads) * static_cast<double>(total_bytes_);
}

Channels SolveFrame::ambient(std::span<const Channels> unshot) const {
    Channels level{0, 0, 0}, absorbed{0, 0, 0};
    for (PatchNumber i = 0; i < unshot.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            level[c] += (transport_.area_m2(i) - transport_.diagonal_m2(i)) * unshot[i][c];  // what leaves the patch
            absorbed[c] += transport_.area_m2(i) * (1 - transport_.reflectance(i, c));
        }
    for (std::size_t c = 0; c < 3; ++c) level[c] = absorbed[c] > 0 ? std::max(level[c], 0.0) / absorbed[c] : 0.0;
    return level;
}

std::vector<Channels> SolveFrame::scaled_irradiance(std::span<const Channels> irradiance,
                                                    const Channels& ambient) const {
    std::vector<Channels> scaled(irradiance.size());
    for (PatchNumber i = 0; i < scaled.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double received = std::max(irradiance[i][c] + ambient[c] * transport_.self_factor(i, c), 0.0);
            const double radiosity = emitted(i, c) + transport_.scaled_reflectance(i)[c] * received;
            const double own = transport_.diagonal_m2(i) / transport_.area_m2(i) * radiosity;
            scaled[i][c] = std::max(received + own, 0.0) / scale_[c];
        }
    return scaled;
}

SolveResult SolveFrame::finish(const SolverVectors& solver) {
    SolveResult result = std::move(result_);
    result.history = history_.steps();
    result.irradiance = scaled_irradiance(solver.irradiance(), {0, 0, 0});
    const std::size_t count = result.irradiance.size();
    result.radiosity.resize(count);
    result.unshot.resize(count);
    for (PatchNumber i = 0; i < count; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double received = std::max(solver.irradiance()[i][c], 0.0);
            result.radiosity[i][c] = (emitted(i, c) + transport_.scaled_reflectance(i)[c] * received) / scale_[c];
            result.unshot[i][c] = solver.unshot()[i][c] / scale_[c];
        }
    return result;
}

void ErrorSums::add(std::size_t c, double area_m2, double weight, double unshot_radiosity, double radiosity) {
    const double left = area_m2 * std::abs(unshot_radiosity);
    unshot[c] += left;
    weighted[c] += weight * left;
    if (unshot_radiosity < 0) negative[c] += weight * left;
    power[c] += area_m2 * radiosity;
}

void ErrorSums::add(const ErrorSums& other) {
    for (std::size_t c = 0; c < 3; ++c) {
        weighted[c] += other.weighted[c];
        unshot[c] += other.unshot[c];
        negative[c] += other.negative[c];
        power[c] += other.power[c];
    }
}

double ErrorSums::bound(const Channels& emitted) const {
    double worst = 0;
    for (std::size_t c = 0; c < 3; ++c)
        if (weighted[c] > 0) worst = std::max(worst, weighted[c] / std::max(power[c] - negative[c], emitted[c]));
    return worst;
}

}  // namespace luxel
