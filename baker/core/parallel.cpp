#include "baker/core/parallel.h"

#include <pmmintrin.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <xmmintrin.h>

#include <algorithm>

#ifdef LUXEL_TSAN
// Debian's libtbb is not instrumented: these tell the thread sanitizer what the library orders by itself.
extern "C" void AnnotateHappensBefore(const char*, int, const volatile void*);
extern "C" void AnnotateHappensAfter(const char*, int, const volatile void*);
namespace {
int loop_start_token, loop_end_token;
}
#define LUXEL_BEFORE(token) AnnotateHappensBefore(__FILE__, __LINE__, &(token))
#define LUXEL_AFTER(token) AnnotateHappensAfter(__FILE__, __LINE__, &(token))
#else
#define LUXEL_BEFORE(token) (void)0
#define LUXEL_AFTER(token) (void)0
#endif

namespace luxel {

namespace {

/// The caller's side of a loop: what is before the loop happens before every body, and every body before what follows.
struct LoopOrder {
    LoopOrder() { LUXEL_BEFORE(loop_start_token); }
    ~LoopOrder() { LUXEL_AFTER(loop_end_token); }
};

/// The body's side. Destructors, so that a body which throws is ordered too.
struct BodyOrder {
    BodyOrder() { LUXEL_AFTER(loop_start_token); }
    ~BodyOrder() { LUXEL_BEFORE(loop_end_token); }
};

}  // namespace

void flush_denormals() {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
}

ThreadLimit::ThreadLimit(unsigned threads)
    : threads_(threads ? threads : static_cast<unsigned>(tbb::info::default_concurrency())),
      state_(new tbb::global_control(tbb::global_control::max_allowed_parallelism, threads_)) {
    flush_denormals();
}

ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(state_); }

void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t)>& body) {
    parallel_ranges(count, std::max<std::size_t>(grain, 1), [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) body(i);
    });
}

void parallel_ranges(std::size_t count, std::size_t range_size,
                     const std::function<void(std::size_t, std::size_t, std::size_t)>& body) {
    const std::size_t ranges = (count + range_size - 1) / range_size;
    const auto run_range = [&](std::size_t range) {
        const BodyOrder body_order;
        flush_denormals();
        body(range, range * range_size, std::min(count, (range + 1) * range_size));
    };
    // Not bound to the loop around it: when that fails, the library would leave this one out in silence, and the body that
    // called it would go on as if it had run.
    tbb::task_group_context context(tbb::task_group_context::isolated);
    const LoopOrder loop_order;  // after the body and what it refers to: these too are written before the loop
    tbb::parallel_for(std::size_t{0}, ranges, run_range, context);
}

void parallel_isolated(std::size_t count, const std::function<void(std::size_t)>& body) {
    tbb::this_task_arena::isolate([&] { parallel_for(count, 1, body); });
}

}  // namespace luxel
