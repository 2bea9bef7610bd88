/// Counts and closure together: the matrix of exchange areas.
#pragma once
#include <atomic>

#include "baker/store/matrix_store.h"

namespace luxel {

class ClosedMatrix final : public BlockSource {
  public:
    /// References must outlive it.
    ClosedMatrix(const MatrixStore& counts, std::span<const double> area_m2, const Closure& closure)
        : counts_(counts), area_m2_(area_m2), closure_(closure) {}
    [[nodiscard]] const ChunkLayout& layout() const override { return counts_.layout(); }
    [[nodiscard]] std::span<const double> area_m2() const override { return area_m2_; }
    [[nodiscard]] std::span<const double> diagonal_m2() const override { return closure_.diagonal_m2; }
    [[nodiscard]] std::span<const BlockInfo> blocks() const override { return counts_.blocks(); }
    void load(std::size_t index, Block& out) override;
    [[nodiscard]] std::uint64_t bytes_read() const override { return bytes_read_; }

  private:
    const MatrixStore& counts_;
    std::span<const double> area_m2_;
    const Closure& closure_;
    std::atomic<std::uint64_t> bytes_read_{0};
};

}  // namespace luxel
