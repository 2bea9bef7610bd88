/// The ambient term of progressive refinement, made exact: light in known patterns is sent without a read.
///
/// A vector P of the space is radiosity of the patches of one chunk, and its column G P is found while the row of the
/// chunk is read anyway. Sending sum_v c_v P_v then costs no read: irradiance grows by sum_v c_v G P_v / A, and unshot
/// light U becomes
///     U - P c + K P c,   (K P)_i = rho'_i (G P)_i / A_i.
/// What is sent is accounted for exactly, whatever the levels c are, so that the fixed point U = 0 stays what it was.
/// The levels are Galerkin's, the best ones in the energy norm of the symmetric form (A / rho' - G) B = A M / rho':
///     (P^T (A / rho') P - P^T G P) c = P^T (A / rho') U,
/// sparse, since a chunk sees few others, and positive definite where light ends.
///
/// Sources: ambient term: Cohen, Chen, Wallace, Greenberg 1988; adaptive aggregation: Chatelin and Miranker, Linear
/// Algebra and its Applications 43 (1982); vectors kept from earlier solves: Parks, de Sturler, Mackey, Johnson, Maiti,
/// SIAM J. Sci. Comput. 28(5) 2006. Which vectors: coarse_vectors.h and shoot.cpp.
///
/// Memory: 24 bytes per entry (entries()), a patch that sends or receives by a vector, and 2 for its number. Threads:
/// set_column() may be called at the same time for different vectors or blocks, the rest one at a time.
#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "baker/solver/transport.h"

namespace luxel {

class CoarseSpace {
  public:
    explicit CoarseSpace(const Transport& transport);

    /// As many entries as a solve of so many patches may have: 64 per patch in small scenes, 4 in large ones; a
    /// million in between.
    [[nodiscard]] static constexpr std::uint64_t most_entries(std::uint64_t patches) {
        return std::clamp<std::uint64_t>(1'000'000, 4 * patches, 64 * patches);
    }
    /// Of one entry: in the space, and in a copy by save().
    static constexpr std::uint64_t bytes_per_entry = 26, saved_bytes_per_entry = 32;

    /// Begins a vector: radiosity P of the chunk's patches, 0 where nothing is reflected, and what they receive of it
    /// themselves, own = G_kk P; spare lanes are not used. What the chunk's other vectors hold of it already is taken
    /// out (Gram and Schmidt, in the energy norm, channel by channel), and it is given the norm 1. Returns its number,
    /// or nothing if hardly anything is left.
    std::optional<std::size_t> add(ChunkNumber chunk, std::span<const Lanes> radiosity, std::span<const Lanes> own);
    /// P of a vector, spare lanes 0.
    [[nodiscard]] std::vector<Lanes> radiosity(std::size_t vector) const;
    /// What the chunk number `place` of row(chunk) receives: G P, one entry per patch of the other chunk. Once per
    /// place.
    void set_column(std::size_t vector, std::size_t place, std::span<const Lanes> exchange);
    /// All columns are set; vectors are finished in the order of their numbers. From here on it is part of the model.
    void finish(std::size_t vector);

    [[nodiscard]] std::size_t vector_count() const { return vectors_.size(); }
    [[nodiscard]] std::size_t count_of(ChunkNumber chunk) const { return of_chunk_[chunk].size(); }
    [[nodiscard]] std::uint64_t entries() const { return entries_; }
    /// How many vectors of this chunk the space has room for, those included that it has, while none is begun. Further
    /// vectors than the first only within the chunk's share by its patches: a model that lacks a room is no model.
    [[nodiscard]] std::size_t room_for(ChunkNumber chunk) const;
    /// Entries that a vector of this chunk may have: as its first one, or as many as it can.
    [[nodiscard]] std::uint64_t entries_of(ChunkNumber chunk) const;

    /// c of every vector for the unshot light U (one entry per patch). Empty if there are no vectors, or the model is
    /// not positive: light that never ends.
    [[nodiscard]] std::vector<Channels> levels(std::span<const Channels> unshot) const;

    /// Sends at these levels: adds to the irradiance (without a patch's own part) and to the unshot light of all
    /// patches what follows. Uses all threads; the result does not depend on their number.
    void send(std::span<const Channels> levels, std::span<Channels> irradiance, std::span<Channels> unshot) const;

    /// c of every vector such that U - P c has no part that the model could see through the matrix: P^T (A / rho') (I -
    /// K) (U - P c) = 0. What deflated conjugate gradients take out of a direction: Saad, Yeung, Erhel, Guyomarc'h,
    /// SIAM J. Sci. Comput. 21(5) 2000.
    [[nodiscard]] std::vector<Channels> deflation(std::span<const Channels> unshot) const;

    /// Radiosity that a chunk sends at these levels, and sum_v c_v G P_v that it receives, per patch.
    struct Exchange {
        std::vector<Channels> sent, received;
    };
    [[nodiscard]] Exchange exchange(ChunkNumber chunk, std::span<const Channels> levels) const;

    /// All vectors as numbers, and back, into an empty space. Throws Error{internal} if they are not those of such a
    /// matrix.
    [[nodiscard]] std::vector<double> save() const;
    void restore(std::span<const double> numbers);

  private:
    /// G P at those patches of another chunk that receive any of it.
    struct Column {
        std::vector<std::uint16_t> rows;  ///< patches, from the first of their chunk
        std::vector<Channels> exchange;   ///< per row
    };
    struct Vector {
        ChunkNumber chunk = 0;
        std::vector<Channels> radiosity, own;
        std::vector<Column> columns;  ///< per place in row(chunk)
    };
    /// P_u^T (A / rho' - G) P_v, one side of the symmetric matrix.
    struct Coupling {
        std::size_t u = 0, v = 0;
        Channels value{0, 0, 0};
    };
    [[nodiscard]] Channels inside(const Vector& u, const Vector& v) const;
    bool make_orthonormal(Vector& vector) const;
    [[nodiscard]] std::vector<Channels> moments(std::span<const Channels> unshot) const;
    [[nodiscard]] std::vector<Channels> solve(std::vector<Channels> moments) const;
    [[nodiscard]] bool solve(std::size_t channel, std::vector<Channels>& levels) const;

    const Transport& transport_;
    std::vector<Vector> vectors_;
    std::vector<std::vector<std::size_t>> of_chunk_;
    std::vector<std::vector<std::size_t>>
        place_in_;  ///< per chunk and place in its row: the chunk's place in the other's row
    std::vector<Coupling> couplings_;
    std::uint64_t entries_ = 0;
};

}  // namespace luxel
