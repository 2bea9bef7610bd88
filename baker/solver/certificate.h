/// The certificate of adjoint.h found by reading all blocks, for reflectances at or near 1.
///
/// Iterates towards w = 1 + T w from w = D, one whole read of the half matrix each: the rows of every chunk solved
/// exactly for the others' old weights (block Jacobi), alternating with a coarse step that scales each chunk's weights
/// by the Galerkin solution with one unknown per chunk (iterative aggregation and disaggregation: Koury, McAllister,
/// Stewart, SIAM J. Alg. Disc. Meth. 5(2) 1984), without which light would leave a long row of white rooms one room per
/// read. Every read also gives w - T w; as soon as its smallest value m is positive w / m is a certificate (property
/// 4), so the iteration need not converge; it stops when m shows that w / m is tight.
///
/// Patches that no light can reach are found in the same reads (spare lane); what they reflect cannot matter, and a
/// sealed white room without a lamp must not void the certificate of the others.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "baker/solver/transport.h"

namespace luxel {

/// Never more whole reads than this.
constexpr std::uint32_t max_certificate_reads = 40;

/// Weights per patch, or nothing if none were found. `must_exist`: throw Error{bad_input}, "the light never ends",
/// instead. May forget() patches that no light reaches. Memory: 57 bytes per patch beside the result. Threads: uses
/// them; the result does not depend on their number.
std::optional<std::vector<Channels>> certificate_by_reads(Transport& transport, std::span<const std::uint8_t> emits,
                                                          bool must_exist);

}  // namespace luxel
