/// Gathering: every patch collects what the others send, again and again, until nothing changes. Certified like
/// shooting.
///
/// `jacobi` collects from the radiosities of the sweep before: the plain series of bounces, the baseline. `gather` is
/// Gauss-Seidel by strips (Cohen and Greenberg, SIGGRAPH 85, solve their full matrix so, row by row): chunk after chunk
/// gathers along its strip, solves the exchange inside itself, and scatters its new radiosity down the strip, whose
/// blocks stay in memory meanwhile (up to two million pairs, the rest is asked for again): a sweep is one read of the
/// half matrix.
///
/// Bound. Jacobi is shooting all at once: U = B - B_before. In a sweep of gather a chunk has seen the new radiosity x
/// of the chunks before it and the old one of those behind. With D the change of x in the sweep and r what the inner
/// solve left, x - M' - K x is at most |r| + K |D|, hence (adjoint.h: T w <= w - 1)
///     sum A |B* - B|, sum A |H* - H| <= sum A w (|r| + |D|).
///
/// Memory: `jacobi` 80 bytes per patch and those of whole_read.h; `gather` 104 bytes per patch, transport_batch_blocks
/// chunk vectors, 12 MB of a strip, a decoded block per thread. Threads, determinism and errors as in shoot.h.
#pragma once
#include "baker/solver/solver.h"

namespace luxel {

SolveResult solve_by_jacobi(BlockSource& source, const SolveInput& input, const SolveOptions& options);
SolveResult solve_by_gathering(BlockSource& source, const SolveInput& input, const SolveOptions& options);

}  // namespace luxel
