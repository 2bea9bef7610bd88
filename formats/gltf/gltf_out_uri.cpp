#include "formats/gltf/gltf_out_uri.h"

namespace luxel {

std::string encode_percent(std::string_view file_name) {
    constexpr std::string_view digits = "0123456789ABCDEF", plain = "-._~";
    std::string uri;
    for (const char c : file_name) {
        const auto byte = static_cast<unsigned char>(c);
        const bool is_plain = (byte >= 'a' && byte <= 'z') || (byte >= 'A' && byte <= 'Z') ||
                              (byte >= '0' && byte <= '9') || plain.find(c) != std::string_view::npos;
        if (is_plain)
            uri += c;
        else
            uri.append({'%', digits[byte >> 4], digits[byte & 15]});
    }
    return uri;
}

}  // namespace luxel
