/// Is the head of this OpenEXR file one that its library can be given? It takes sizes at their word: an attribute, a tile or a
/// table of offsets that a file of a few bytes claims would be allocated, up to gigabytes, before anything is read.
///
/// Threads: pure. Source: OpenEXR File Layout (Structure, Version Field, Header, Offset Tables; Predefined Attribute Types).
#pragma once
#include <string>

#include "formats/image/image_file.h"

namespace luxel {

/// Empty text, or what is wrong. Of every part: attributes lie within the file and have the size of their type, tables of offsets
/// fit into the file, pixels and tiles are within the limits. Deep pictures are refused.
std::string exr_trouble(ByteView bytes, const ImageLimits& limits);

}  // namespace luxel
