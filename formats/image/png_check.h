/// Is this byte string a whole, undamaged PNG? Asked before libpng sees it, since that library prints to the terminal
/// when it meets damage, and its words do not say where.
///
/// Threads: pure. Source: PNG Specification (Third Edition), sections 5.3 (chunk layout) and 5.5 (CRC algorithm).
#pragma once
#include <string>

#include "formats/base/bytes.h"

namespace luxel {

/// Empty text, or what is wrong with which chunk at which byte. Bytes after IEND are ignored, as decoders do.
std::string png_damage(ByteView bytes);

}  // namespace luxel
