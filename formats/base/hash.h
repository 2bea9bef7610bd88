/// XXH3: checksums of stored bytes (64 bit) and names of stage results (128 bit). Only user of xxHash.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace luxel {

/// 64-bit checksum of bytes; `seed` ties the sum to something else (a codec id, a position).
std::uint64_t hash64(std::span<const std::uint8_t> bytes, std::uint64_t seed = 0);

/// The name of a value: 128 bits over everything that went into it.
struct Key {
    std::uint64_t low = 0, high = 0;
    bool operator==(const Key&) const = default;
    /// 32 lower-case hexadecimal digits.
    [[nodiscard]] std::string text() const;
};

/// The key that Key::text() wrote; empty for anything else.
std::optional<Key> parse_key(std::string_view text);

/// Builds a Key from parts. Every part is preceded by its size, so ("ab","c") and ("a","bc") differ.
class KeyBuilder {
  public:
    explicit KeyBuilder(std::string_view purpose);
    ~KeyBuilder();
    KeyBuilder(const KeyBuilder&) = delete;
    KeyBuilder& operator=(const KeyBuilder&) = delete;
    KeyBuilder& bytes(std::span<const std::uint8_t> part);
    KeyBuilder& text(std::string_view part);
    KeyBuilder& number(double part);
    KeyBuilder& integer(std::int64_t part);
    KeyBuilder& key(const Key& part);
    template <class T>
        requires std::is_trivially_copyable_v<T>
    KeyBuilder& array(std::span<const T> part) {
        return bytes({reinterpret_cast<const std::uint8_t*>(part.data()), part.size_bytes()});
    }
    [[nodiscard]] Key finish() const;

  private:
    void* state_;
};

}  // namespace luxel
