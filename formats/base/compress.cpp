#include "formats/base/compress.h"

#include <zstd.h>

namespace luxel {

Bytes compress(ByteView raw, int level) {
    Bytes frame(ZSTD_compressBound(raw.size()));
    const std::size_t size = ZSTD_compress(frame.data(), frame.size(), raw.data(), raw.size(), level);
    if (ZSTD_isError(size)) throw Error(ErrorCode::internal, "zstd", ZSTD_getErrorName(size));
    frame.resize(size);
    return frame;
}

Bytes decompress(ByteView frame, std::uint64_t raw_bytes, const std::string& where) {
    const auto damaged = [&](const std::string& what) {
        return Error(ErrorCode::damaged_store, where, what, "remove the file and run the same command again");
    };
    const unsigned long long stated = ZSTD_getFrameContentSize(frame.data(), frame.size());
    if (stated != raw_bytes)
        throw damaged("zstd frame of " + std::to_string(stated) + " bytes, expected " + std::to_string(raw_bytes));
    Bytes raw(raw_bytes);
    const std::size_t size = ZSTD_decompress(raw.data(), raw.size(), frame.data(), frame.size());
    if (ZSTD_isError(size)) throw damaged(std::string("zstd: ") + ZSTD_getErrorName(size));
    if (size != raw_bytes) throw damaged("zstd frame is short");
    return raw;
}

}  // namespace luxel
