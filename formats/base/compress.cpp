#include "formats/base/compress.h"

#include <zstd.h>

#include <memory>
#include <utility>

namespace luxel {
namespace {

/// Contexts take longer to make than a small frame to decode, so every thread keeps one of each. They hold no state from
/// one frame to the next.
ZSTD_CCtx* compressing() {
    thread_local const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(), ZSTD_freeCCtx);
    if (!context) throw Error(ErrorCode::internal, "zstd", "no memory for a context");
    ZSTD_CCtx_reset(context.get(), ZSTD_reset_session_and_parameters);
    return context.get();
}

ZSTD_DCtx* decompressing() {
    thread_local const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
    if (!context) throw Error(ErrorCode::internal, "zstd", "no memory for a context");
    return context.get();
}

/// A block of a frame is four bytes or more and holds 128 KiB or less: nothing in a frame of its size can be more. A
/// frame that claims more is not given memory.
constexpr std::uint64_t most_expansion = 128 * 1024 / 4;

}  // namespace

Bytes compress(ByteView raw, int level) {
    Bytes frame(ZSTD_compressBound(raw.size()));
    const std::size_t size = ZSTD_compressCCtx(compressing(), frame.data(), frame.size(), raw.data(), raw.size(), level);
    if (ZSTD_isError(size)) throw Error(ErrorCode::internal, "zstd", ZSTD_getErrorName(size));
    frame.resize(size);
    return frame;
}

Bytes compress_literals(ByteView raw) {
    ZSTD_CCtx* const context = compressing();
    // Only long repeats, looked for in a small table: short ones cost more than the bytes themselves, entropy coded.
    for (const auto& [parameter, value] : {std::pair{ZSTD_c_strategy, static_cast<int>(ZSTD_fast)}, {ZSTD_c_minMatch, 7},
                                           {ZSTD_c_hashLog, 6}, {ZSTD_c_windowLog, 17}})
        if (ZSTD_isError(ZSTD_CCtx_setParameter(context, parameter, value)))
            throw Error(ErrorCode::internal, "zstd", "a parameter is refused");
    Bytes frame(ZSTD_compressBound(raw.size()));
    const std::size_t size = ZSTD_compress2(context, frame.data(), frame.size(), raw.data(), raw.size());
    if (ZSTD_isError(size)) throw Error(ErrorCode::internal, "zstd", ZSTD_getErrorName(size));
    frame.resize(size);
    return frame;
}

Bytes decompress(ByteView frame, std::uint64_t raw_bytes, const std::string& where) {
    Bytes raw;
    decompress_into(frame, raw_bytes, where, 0, raw);
    return raw;
}

void decompress_into(ByteView frame, std::uint64_t raw_bytes, const std::string& where, std::size_t slack, Bytes& raw) {
    const auto damaged = [&](const std::string& what) {
        return Error(ErrorCode::damaged_store, where, what, "remove the file and run the same command again");
    };
    const unsigned long long stated = ZSTD_getFrameContentSize(frame.data(), frame.size());
    if (stated != raw_bytes)
        throw damaged("zstd frame of " + std::to_string(stated) + " bytes, expected " + std::to_string(raw_bytes));
    if (raw_bytes / most_expansion > frame.size())
        throw damaged("zstd frame of " + std::to_string(frame.size()) + " bytes cannot hold " +
                      std::to_string(raw_bytes));
    raw.reserve(raw_bytes + slack);
    raw.resize(raw_bytes);
    const std::size_t size = ZSTD_decompressDCtx(decompressing(), raw.data(), raw.size(), frame.data(), frame.size());
    if (ZSTD_isError(size)) throw damaged(std::string("zstd: ") + ZSTD_getErrorName(size));
    if (size != raw_bytes) throw damaged("zstd frame is short");
}

}  // namespace luxel
