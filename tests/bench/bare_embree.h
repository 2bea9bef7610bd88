/// The yardstick of the evidence stage: Embree alone, packets of eight, over rays that are ready in memory. It knows nothing
/// of patches and keeps nothing but a checksum of the hits.
#pragma once
#include <memory>
#include <span>

#include "baker/trace/tracer.h"

namespace luxel::bench {

class BareEmbree {
  public:
    /// The same flags, quality and instruction set as the tracer's.
    explicit BareEmbree(const Scene& scene);
    ~BareEmbree();
    BareEmbree(const BareEmbree&) = delete;
    BareEmbree& operator=(const BareEmbree&) = delete;
    /// Sum of the triangles met, so that the loop cannot be left out. Threads: reentrant.
    [[nodiscard]] std::uint64_t trace(std::span<const TraceRay> rays) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace luxel::bench
