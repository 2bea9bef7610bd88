/// Explicit little-endian bytes: every number in every file of ours passes through here.
/// Writer appends; Cursor reads with bounds checks and names the field that is missing.
#pragma once
#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "formats/base/error.h"

namespace luxel {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

static_assert(std::endian::native == std::endian::little, "arrays are copied as they are: a big-endian build needs swaps");

template <class T>
concept Scalar = std::is_arithmetic_v<T> && !std::same_as<T, bool>;

class ByteWriter {
  public:
    template <Scalar T>
    void put(T value) {
        put_array(std::span<const T>(&value, 1));
    }
    template <Scalar T>
    void put_array(std::span<const T> values) {
        const auto* first = reinterpret_cast<const std::uint8_t*>(values.data());
        bytes_.insert(bytes_.end(), first, first + values.size_bytes());
    }
    /// LEB128: 7 bits a byte, low bits first, at most 10 bytes.
    void put_varint(std::uint64_t value) {
        while (value >= 0x80) {
            bytes_.push_back(static_cast<std::uint8_t>(value | 0x80));
            value >>= 7;
        }
        bytes_.push_back(static_cast<std::uint8_t>(value));
    }
    /// varint length, then the bytes.
    void put_text(const std::string& text) {
        put_varint(text.size());
        bytes_.insert(bytes_.end(), text.begin(), text.end());
    }
    [[nodiscard]] const Bytes& bytes() const { return bytes_; }
    [[nodiscard]] Bytes take() { return std::move(bytes_); }
    [[nodiscard]] std::size_t size() const { return bytes_.size(); }

  private:
    Bytes bytes_;
};

/// Reads what ByteWriter wrote. Every get throws Error{damaged_store} with file, field and offset when the bytes end.
/// The view must outlive the cursor.
class ByteCursor {
  public:
    ByteCursor(ByteView bytes, std::string where) : bytes_(bytes), where_(std::move(where)) {}

    template <Scalar T>
    T get(const char* field) {
        T value;
        need(sizeof(T), field);
        std::memcpy(&value, bytes_.data() + at_, sizeof(T));
        at_ += sizeof(T);
        return value;
    }
    template <Scalar T>
    std::vector<T> get_array(std::uint64_t count, const char* field) {
        if (count > remaining() / sizeof(T)) fail(field, "array is longer than what is left");
        std::vector<T> values(count);
        if (count) std::memcpy(values.data(), bytes_.data() + at_, count * sizeof(T));
        at_ += count * sizeof(T);
        return values;
    }
    /// `count` bytes in place: valid as long as the bytes that the cursor reads.
    ByteView get_view(std::uint64_t count, const char* field) {
        if (count > remaining()) fail(field, "bytes are more than what is left");
        const ByteView view = bytes_.subspan(at_, count);
        at_ += count;
        return view;
    }
    std::uint64_t get_varint(const char* field) {
        std::uint64_t value = 0;
        for (unsigned shift = 0;; shift += 7) {
            need(1, field);
            const std::uint8_t byte = bytes_[at_++];
            if (shift == 63 && byte > 1) fail(field, "varint is 2^64 or more");
            value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
            if (!(byte & 0x80)) return value;
        }
    }
    std::string get_text(const char* field) {
        const std::uint64_t length = get_varint(field);
        if (length > remaining()) fail(field, "text is longer than what is left");
        std::string text(reinterpret_cast<const char*>(bytes_.data() + at_), length);
        at_ += length;
        return text;
    }
    [[nodiscard]] std::size_t at() const { return at_; }
    [[nodiscard]] std::size_t remaining() const { return bytes_.size() - at_; }
    void expect_end(const char* field) const {
        if (remaining()) fail(field, "bytes left over");
    }
    [[noreturn]] void fail(const char* field, const std::string& why) const {
        throw Error(ErrorCode::damaged_store, where_, std::string(field) + " at byte " + std::to_string(at_) + ": " + why,
                    "the file is damaged; remove it and run the same command again");
    }

  private:
    void need(std::size_t count, const char* field) const {
        if (remaining() < count) fail(field, "file ends here");
    }
    ByteView bytes_;
    std::string where_;
    std::size_t at_ = 0;
};

template <class T>
ByteView bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(T)};
}

}  // namespace luxel
