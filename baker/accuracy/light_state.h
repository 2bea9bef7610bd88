/// What is known of the light after a round of evidence: the input of everything that judges its accuracy.
#pragma once
#include <cstdint>
#include <span>

#include "baker/patches/patch.h"
#include "baker/solver/solver.h"

namespace luxel {

/// One entry per patch everywhere; the data belongs to the caller.
struct LightState {
    std::span<const PatchId> ids;
    std::span<const double> area_m2;
    std::span<const Rgb> reflectance;
    std::span<const Channels> radiosity;   ///< B, lm/m2
    std::span<const Channels> row_mean;    ///< K, lm/m2: row_mean.h
    std::span<const double> mu;            ///< Closure::mu, rays/m2, > 0
    std::span<const double> open_m2;       ///< Closure::row_open_m2
    /// A number below that of the patches: those that share it lie side by side on one surface, and see nearly the same.
    std::span<const std::uint32_t> neighbourhood;
    bool each_channel = false;  ///< channels are judged one by one, though they may be the same
};

/// Throws Error{internal} when a size differs from the others.
void check(const LightState& light);

/// No patch has any radiosity in this channel.
bool is_dark(const LightState& light, std::size_t channel);
/// Radiosity and reflectance of every patch are the same in both channels: what holds for one holds for the other. Never with `each_channel`.
bool same_channel(const LightState& light, std::size_t a, std::size_t b);

}  // namespace luxel
