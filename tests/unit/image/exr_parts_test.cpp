// OpenEXR files with several parts: names, channels, samples and values come back, the same bytes twice, failures are
// said.
#include "tests/support/exr_parts.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

#include "formats/image/exr_part.h"
#include "formats/image/image_file.h"

namespace luxel {
namespace {

constexpr std::uint32_t width = 70, height = 33;

std::vector<ExrPart> heads() {
    ImageMetadata light, number;
    light.quantity = "irradiance";
    light.unit = "lux";
    light.software = "luxel test";
    number.quantity = "number of the patch";
    return {{"direct", {"R", "G", "B"}, ExrSample::float_32, light},
            {"patch", {"Y"}, ExrSample::uint_32, number},
            {"normal", {"X", "Y", "Z"}, ExrSample::half_float, {}}};
}

ExrPartValues values_of(std::size_t part) {
    if (part == 1) {
        std::vector<std::uint32_t> numbers(width * height);
        for (std::uint32_t k = 0; k < numbers.size(); ++k) numbers[k] = k % 7 ? 0xffffffffu - k : k;
        return numbers;
    }
    std::vector<float> floats(std::size_t{width} * height * 3);
    for (std::size_t k = 0; k < floats.size(); ++k)
        floats[k] = part == 0 ? static_cast<float>(k) * 0.37f : static_cast<float>(k % 64) / 64;
    return floats;
}

TEST(ExrParts, ComeBackAsTheyWere) {
    const std::vector<ExrPart> parts = heads();
    std::vector<std::size_t> asked;
    const Bytes file = encode_exr_parts(width, height, parts, [&](std::size_t part) {
        asked.push_back(part);
        return values_of(part);
    });
    EXPECT_EQ(asked, (std::vector<std::size_t>{0, 1, 2})) << "each once, in order";
    EXPECT_EQ(file, encode_exr_parts(width, height, parts, values_of));
    const auto read = test::read_exr_parts(file);
    ASSERT_EQ(read.size(), 3u);
    for (std::size_t k = 0; k < read.size(); ++k) {
        EXPECT_EQ(read[k].name, parts[k].name);
        EXPECT_EQ(read[k].channels, parts[k].channels);
        EXPECT_EQ(read[k].width, width);
        EXPECT_EQ(read[k].height, height);
        const ExrPartValues expected = values_of(k);
        if (k == 1)
            EXPECT_EQ(read[k].numbers, std::get<std::vector<std::uint32_t>>(expected));
        else
            EXPECT_EQ(read[k].floats, std::get<std::vector<float>>(expected));
    }
    EXPECT_EQ(read[0].sample, "float");
    EXPECT_EQ(read[1].sample, "uint");
    EXPECT_EQ(read[2].sample, "half");
    EXPECT_EQ(read[0].texts.at("quantity"), "irradiance");
    EXPECT_EQ(read[0].texts.at("unit"), "lux");
    EXPECT_EQ(read[0].texts.at("Software"), "luxel test");
    EXPECT_EQ(read[1].texts.at("quantity"), "number of the patch");
}

TEST(ExrParts, AreReadByName) {
    const std::vector<ExrPart> parts = heads();
    const Bytes file = encode_exr_parts(width, height, parts, values_of);
    for (const std::size_t k : {std::size_t{1}, std::size_t{2}}) {
        const DecodedExrPart part = decode_exr_part(file, parts[k].name, "made.exr");
        EXPECT_EQ(part.channels, parts[k].channels);
        EXPECT_EQ(part.width, width);
        EXPECT_EQ(part.height, height);
        EXPECT_EQ(part.values, values_of(k));
    }
    const DecodedExrPart direct = decode_exr_part(file, "direct", "made.exr");
    EXPECT_EQ(direct.channels, (std::vector<std::string>{"B", "G", "R"})) << "by their names";
    const auto found = std::get<std::vector<float>>(direct.values), given = std::get<std::vector<float>>(values_of(0));
    ASSERT_EQ(found.size(), given.size());
    for (std::size_t pixel = 0; pixel < given.size(); pixel += 3)
        for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(found[pixel + c], given[pixel + 2 - c]);
}

TEST(ExrParts, ThatAreNotThereOrDamagedAreNamed) {
    const Bytes file = encode_exr_parts(width, height, heads(), values_of);
    const auto message = [](const Bytes& bytes, const char* name) {
        try {
            decode_exr_part(bytes, name, "made.exr");
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::bad_input);
            return error.where + ": " + error.what_text;
        }
        return std::string("read");
    };
    EXPECT_EQ(message(file, "beauty"), "made.exr: cannot decode as OpenEXR: expected a part \"beauty\", found direct, patch, normal");
    EXPECT_EQ(message(encode_exr_parts(width, height, std::vector{heads()[1]}, [](std::size_t) { return values_of(1); }), "patch"), "read");
    for (std::size_t size = 0; size < file.size(); size += 97)
        EXPECT_TRUE(message(Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)), "normal").starts_with("made.exr: cannot decode")) << size;
}

TEST(ExrParts, OneAlone) {
    const std::vector<ExrPart> parts{heads()[1]};
    const auto read =
        test::read_exr_parts(encode_exr_parts(width, height, parts, [](std::size_t) { return values_of(1); }));
    ASSERT_EQ(read.size(), 1u);
    EXPECT_EQ(read[0].name, "patch");
    EXPECT_EQ(read[0].numbers, std::get<std::vector<std::uint32_t>>(values_of(1)));
}

TEST(ExrParts, WhatDoesNotFitIsRefused) {
    const std::vector<ExrPart> parts = heads();
    const auto code = [&](const std::function<ExrPartValues(std::size_t)>& values) {
        try {
            (void)encode_exr_parts(width, height, parts, values);
        } catch (const Error& error) {
            return error.code;
        }
        return ErrorCode{};
    };
    EXPECT_EQ(code([](std::size_t) { return std::vector<float>(7); }), ErrorCode::internal) << "too few";
    EXPECT_EQ(code([](std::size_t) { return std::vector<std::uint32_t>(std::size_t{width} * height * 3); }),
              ErrorCode::internal)
        << "another kind";
    EXPECT_EQ(code([](std::size_t part) -> ExrPartValues {
                  if (part == 2) throw Error(ErrorCode::bad_input, "here", "what");
                  return values_of(part);
              }),
              ErrorCode::bad_input)
        << "passed on from where the values come from";
}

TEST(ExrParts, NoFileIsWrittenOnTheWay) {
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto old = std::signal(SIGXFSZ, SIG_IGN);
    const Bytes whole = encode_exr_parts(width, height, heads(), values_of);
    rlimit none = before;
    none.rlim_cur = 0;
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &none), 0);
    const Bytes again = encode_exr_parts(width, height, heads(), values_of);
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, old);
    EXPECT_EQ(again, whole);
}

}  // namespace
}  // namespace luxel
