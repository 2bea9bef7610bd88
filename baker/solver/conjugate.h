/// Conjugate gradients on the symmetric form of the whole system: the choice where light wanders through all chunks
/// alike.
///
/// With s_i = sqrt(rho'_i / A_i) and B = M' + s v, B = M' + K B becomes (I - s G s) v = s G M', symmetric and positive
/// definite as long as light ends (Neumann and Tobler, Eurographics Workshop on Rendering 1994; chunk_system.h does the
/// same inside a chunk). A residual r leaves U = s r unshot, so every step has the bound of shoot.h without a further
/// read. Patches that reflect nothing have s = 0 and drop out; one more read at the end gathers for all patches, and
/// its bound is that of the result. Source: Hestenes and Stiefel 1952.
///
/// The first read also finds what the even light of every chunk sends (coarse_space.h); from then on the model takes
/// its part of the residual exactly, and is taken out of every direction (deflation), without a read. Left out where it
/// would take too much memory.
///
/// One read of the half matrix per step. Memory: 300 bytes per patch, the coarse space, and those of whole_read.h.
/// Threads, determinism and errors as in shoot.h.
#pragma once
#include "baker/solver/solver.h"

namespace luxel {

SolveResult solve_by_conjugate_gradients(BlockSource& source, const SolveInput& input, const SolveOptions& options);

}  // namespace luxel
