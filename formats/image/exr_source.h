/// Bytes in memory as the OpenEXR library reads a file. Private to this folder.
///
/// Ownership: the bytes stay the caller's. Errors: std::runtime_error where they end too early.
#pragma once
#include <OpenEXR/ImfIO.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "formats/base/bytes.h"

namespace luxel {

constexpr int no_threads = 0;  // callers parallelise over pictures; threads inside would only compete with them

class MemorySource : public Imf::IStream {
  public:
    explicit MemorySource(ByteView bytes) : IStream("memory"), bytes_(bytes) {}
    bool read(char to[], int count) override {
        const auto wanted = static_cast<std::size_t>(count);
        if (count < 0 || at_ > bytes_.size() || wanted > bytes_.size() - at_) throw std::runtime_error("the file ends too early");
        std::memcpy(to, bytes_.data() + at_, wanted);
        at_ += wanted;
        return at_ < bytes_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t at) override { at_ = at; }

  private:
    ByteView bytes_;
    std::uint64_t at_ = 0;
};

}  // namespace luxel
