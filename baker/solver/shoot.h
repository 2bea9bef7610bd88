/// Shooting out of core: progressive refinement by chunk (Cohen, Chen, Wallace, Greenberg 1988; group form: Gortler,
/// Cohen, Slusallek 1994), with a certified bound of the error.
///
/// One shot: take the chunk whose unshot light counts most per byte of its row, read its diagonal block, solve the
/// exchange inside the chunk in memory (chunk_system.h), then read the rest of its row once; every block, while it is
/// in memory, sends the chunk's light to the other chunk and brings the other chunk's adjoint weights back (adjoint.h).
///
/// Error. With S what has been sent, B = M' + K S and U = B - S, the exact solution is B* = B + (I - K)^-1 K U. So
///     sum A |B* - B| <= sum A w |U|   and, for irradiance,   sum A |H* - H| <= sum A w |U|
/// for certified weights w. The bound reported is that sum over a lower bound of sum A B*, which is sum A B minus the
/// weighted negative part of U (what the inner solve or a coarse step overshot), or what is emitted. It includes no
/// rounding: beyond a relative 1e-12 or so it means nothing.
///
/// After a shot a coarse step sends, without a read, what a model of all rows read so far says is still to come
/// (coarse_space.h). What is sent is accounted for exactly, so the bound needs no trust in the model, which also tells
/// weights of all chunks at once. docs/solvers.md has figures.
///
/// Extremes. Each channel is divided by a power of two near its largest emission and multiplied back, which changes no
/// bit of the mantissas. Reflectance 1 is allowed wherever light finds a way out. Result: the same bits for any number
/// of threads and whatever the source has cached; only reads and history[].bytes_read, which say what came from the
/// disk, depend on a cache. Memory: 168 bytes per patch with the result, the coarse space (coarse_space.h),
/// transport_batch_blocks times 3 chunk vectors of 32 bytes a patch, a decoded block per thread, the diagonal block of
/// one chunk. Errors: Error{bad_input} when the light never ends or an input is negative or not a number.
#pragma once
#include "baker/solver/solver.h"

namespace luxel {

/// No reads at all where there is no light or nothing reflects. Throws what source.load() throws.
SolveResult solve_by_shooting(BlockSource& source, const SolveInput& input, const SolveOptions& options);

}  // namespace luxel
