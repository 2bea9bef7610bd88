/// The options of how the model is written: formats and profiles of its lightmaps, compression, parts. Their arguments, and what they mean for a bake.
#pragma once
#include <CLI/App.hpp>
#include <cstdint>
#include <string>

#include "baker/bake/bake.h"

namespace luxel {

struct ModelArguments {
    std::string format, encoding, dither = "on", profile = "three";  ///< empty: what the profile has
    std::string draco_bits, split = "none";
    bool unlit = false, draco = false, meshopt = false;
    double unlit_exposure = 0;
    std::uint32_t split_triangles = 1000;
};

void add_model_options(CLI::App& command, ModelArguments& arguments);

/// Throws Error{usage} on what does not go together.
void resolve_model_options(const ModelArguments& arguments, const CLI::App& command, BakeOptions& options);

/// " (png8 within 0.4 %, 95 % of texels within 2 %)": of the worst page; empty where nothing was written.
std::string picture_error_text(const BakeReport& report, const BakeOptions& options);

}  // namespace luxel
