#include "formats/base/hash.h"

#include <xxhash.h>

#include <cstdio>
#include <new>

namespace luxel {

std::uint64_t hash64(std::span<const std::uint8_t> bytes, std::uint64_t seed) {
    return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

std::string Key::text() const {
    char digits[33];
    std::snprintf(digits, sizeof digits, "%016llx%016llx", static_cast<unsigned long long>(high),
                  static_cast<unsigned long long>(low));
    return digits;
}

std::optional<Key> parse_key(std::string_view text) {
    if (text.size() != 32) return {};
    std::array<std::uint64_t, 2> halves{};
    for (std::size_t k = 0; k < 32; ++k) {
        const char c = text[k];
        const bool digit = c >= '0' && c <= '9';
        if (!digit && (c < 'a' || c > 'f')) return {};
        halves[k / 16] = halves[k / 16] << 4 | static_cast<std::uint64_t>(digit ? c - '0' : c - 'a' + 10);
    }
    return Key{halves[1], halves[0]};
}

KeyBuilder::KeyBuilder(std::string_view purpose) : state_(XXH3_createState()) {
    if (!state_) throw std::bad_alloc();
    XXH3_128bits_reset(static_cast<XXH3_state_t*>(state_));
    text(purpose);
}
KeyBuilder::~KeyBuilder() { XXH3_freeState(static_cast<XXH3_state_t*>(state_)); }

KeyBuilder& KeyBuilder::bytes(std::span<const std::uint8_t> part) {
    auto* state = static_cast<XXH3_state_t*>(state_);
    const std::uint64_t size = part.size();
    XXH3_128bits_update(state, &size, sizeof size);
    if (size) XXH3_128bits_update(state, part.data(), part.size());
    return *this;
}
KeyBuilder& KeyBuilder::text(std::string_view part) {
    return bytes({reinterpret_cast<const std::uint8_t*>(part.data()), part.size()});
}
KeyBuilder& KeyBuilder::number(double part) { return array(std::span<const double>(&part, 1)); }
KeyBuilder& KeyBuilder::integer(std::int64_t part) { return array(std::span<const std::int64_t>(&part, 1)); }
KeyBuilder& KeyBuilder::key(const Key& part) { return array(std::span<const Key>(&part, 1)); }

Key KeyBuilder::finish() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(static_cast<const XXH3_state_t*>(state_));
    return {hash.low64, hash.high64};
}

}  // namespace luxel
