#include "baker/solver/certified_solver.h"

#include <utility>

namespace luxel {
namespace {

constexpr std::size_t common_vectors = 3;  // weights, irradiance, unshot

std::optional<std::vector<std::vector<double>>> resumed(SolveFrame& frame,
                                                        std::initializer_list<std::size_t> own_sizes) {
    const std::size_t patches = frame.transport().layout().patch_count();
    std::vector<std::size_t> sizes{1 + 3 * patches, 3 * patches, 3 * patches};
    sizes.insert(sizes.end(), own_sizes);
    return frame.resumed(sizes);
}

}  // namespace

CertifiedSolver::CertifiedSolver(SolveFrame& frame, std::initializer_list<std::size_t> own_sizes)
    : CertifiedSolver(frame, resumed(frame, own_sizes)) {}

CertifiedSolver::CertifiedSolver(SolveFrame& frame, std::optional<std::vector<std::vector<double>>> saved)
    : frame_(frame),
      transport_(frame.transport()),
      adjoint_(saved ? Adjoint::restore(transport_, saved->front()) : Adjoint::certify(transport_, frame.emits())),
      irradiance_(transport_.layout().patch_count(), {0, 0, 0}),
      unshot_(irradiance_) {
    if (!saved) return;
    from_numbers((*saved)[1], irradiance_);
    from_numbers((*saved)[2], unshot_);
    saved->erase(saved->begin(), saved->begin() + common_vectors);
    own_ = std::move(saved);
}

std::vector<std::vector<double>> CertifiedSolver::save() const {
    std::vector<std::vector<double>> numbers{adjoint_.save(transport_), to_numbers(irradiance_), to_numbers(unshot_)};
    for (std::vector<double>& own : own_numbers()) numbers.push_back(std::move(own));
    return numbers;
}

void CertifiedSolver::begin_with_emission() {
    for (ChunkNumber chunk = 0; chunk < transport_.layout().chunk_count(); ++chunk) {
        if (transport_.row_bytes(chunk) == 0) continue;
        for (PatchNumber i = transport_.first(chunk); i < transport_.layout().first_patch[chunk + 1]; ++i)
            for (std::size_t c = 0; c < 3; ++c) unshot_[i][c] = frame_.emitted(i, c);
    }
}

}  // namespace luxel
