/// fuzz_seeds FOLDER: small valid inputs for every target, in a folder named after the target. A fuzzer that starts
/// with them is past the first checks at once.
#include <cstdio>
#include <fstream>
#include <random>

#include "baker/bake/stage_files.h"
#include "baker/unwrap/atlas_file.h"
#include "baker/unwrap/unwrap.h"
#include "formats/bake/directory_file.h"
#include "formats/bake/evidence_file.h"
#include "formats/bake/gap_symbols.h"
#include "formats/bake/patches_file.h"
#include "formats/bake/sky_view_file.h"
#include "formats/base/compress.h"
#include "formats/image/image_file.h"
#include "tests/fuzz/fuzz_file.h"
#include "tests/fuzz/fuzz_scene.h"
#include "tests/fuzz/geometry_seeds.h"
#include "tests/fuzz/gltf_seeds.h"
#include "tests/support/sample_pictures.h"
#include "tests/support/temporary_folder.h"

namespace luxel::fuzz {
namespace {

class Seeds {
  public:
    explicit Seeds(std::filesystem::path folder) : folder_(std::move(folder)) {}

    void write(const std::string& target, const std::string& name, const Bytes& prefix, const Bytes& bytes) const {
        std::filesystem::create_directories(folder_ / target);
        std::ofstream out(folder_ / target / name, std::ios::binary);
        for (const Bytes* part : {&prefix, &bytes})
            out.write(reinterpret_cast<const char*>(part->data()), static_cast<std::streamsize>(part->size()));
    }
    /// The blocks of the file at path() for the kind's own target, and the file for the one of the container.
    void write_file(const std::string& target, const std::string& name, const Bytes& prefix = {}) const {
        write(target, name, prefix, input_for(test::contents_of(path())));
        write("block_file_fuzz", target + "_" + name, {1}, read_file(path()));
    }
    [[nodiscard]] std::filesystem::path path() const { return scratch_ / "file"; }

  private:
    std::filesystem::path folder_;
    test::TemporaryFolder scratch_;
};

/// Of patches 1 to 12, as evidence_fuzz has them.
void evidence(const Seeds& seeds) {
    std::vector<EvidenceRecord> records{{1, 0, 0, 2, 1, 0, {2, 7}, {1, 2}},   {1, 1, 0, 2, 0, 1, {1, 2}, {1, 2}},
                                        {2, 0, 0, 4, 3, 3, {1, 12}, {9, 1}},  {7, 0, 3, 3, 0, 0, {1, 2, 3, 4}, {1, 1, 1, 1}},
                                        {12, 0, 31, 31, 0, 5, {7}, {(1u << 30) - 5}}};
    const std::span<const EvidenceRecord> all(records);
    BlockFileWriter file(seeds.path(), FileKind::evidence, evidence_version, key);
    file.append(0, encode_evidence(all.first(3)), 0);
    file.append(3, encode_evidence(all.last(2)));
    file.publish();
    seeds.write_file("evidence_fuzz", "two_blocks");
}

StripPairs some_pairs(std::uint32_t rows, std::uint32_t columns, bool diagonal, unsigned every, std::mt19937& random) {
    StripPairs block{rows, columns, {0}, {}, {}};
    for (std::uint32_t row = 0; row < rows; ++row) {
        for (std::uint32_t column = diagonal ? row + 1 : 0; column < columns; ++column) {
            if (random() % every) continue;
            block.column.push_back(static_cast<std::uint16_t>(column));
            block.count.push_back(static_cast<std::uint32_t>(1 + random() % (random() % 4 ? 20 : 100000)));
        }
        block.row_begin.push_back(static_cast<std::uint32_t>(block.column.size()));
    }
    return block;
}

/// In chunks of 6 and 70 patches, as strip_fuzz has them.
void strips(const Seeds& seeds) {
    std::mt19937 random(1);
    for (const unsigned every : {1u, 3u, 20u}) {
        const StripPairs own = some_pairs(6, 6, true, every > 3 ? 3 : every, random), other = some_pairs(6, 70, false, every, random);
        StripWriter strip(seeds.path(), key, {{9, 8, 7, 9, 9, 9}, {1, 0, 2, 0, 0, 0}, {0, 8, 1, 0, 0, 0}, {8, 0, 4, 9, 0, 1}});
        strip.append(0, own.column.size(), pack_pairs(own));
        strip.append(1, other.column.size(), pack_pairs(other));
        strip.publish();
        seeds.write_file("strip_fuzz", "every_" + std::to_string(every));
    }
}

/// A small block as pairs_fuzz reads it in the clear; `large`: its large values. All numbers are below 128.
Bytes clear(const StripPairs& block, const Bytes& large) {
    Bytes sizes;
    for (std::uint32_t row = 0; row < block.rows; ++row) sizes.push_back(static_cast<std::uint8_t>(block.row_begin[row + 1] - block.row_begin[row]));
    const Bytes coded = encode_gaps(block);
    const auto framed = [](const Bytes& numbers) { return numbers.empty() ? 0 : 1 + compress_literals(numbers).size(); };
    constexpr std::size_t header = 3;
    const Bytes symbols(coded.begin() + header, coded.end() - static_cast<std::ptrdiff_t>(framed(sizes) + framed(large)));
    Bytes out;
    const auto put = [&](std::size_t number) { out.insert(out.end(), {static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8)}); };
    for (const std::size_t number : {std::size_t{block.rows}, std::size_t{block.columns}, block.column.size()}) put(number);
    for (const Bytes& part : {symbols, sizes, Bytes(), large, Bytes()}) {
        put(part.size());
        out.insert(out.end(), part.begin(), part.end());
    }
    return out;
}

void pairs(const Seeds& seeds) {
    std::mt19937 random(2);
    for (const bool diagonal : {false, true})
        for (const unsigned every : {1u, 5u, 60u}) {
            const StripPairs block = some_pairs(20, 150, diagonal, every, random);
            const std::string name = (diagonal ? "diagonal_" : "other_") + std::to_string(every);
            const auto first = [&](unsigned how) { return Bytes{static_cast<std::uint8_t>(how << 1 | (diagonal ? 1 : 0))}; };
            Bytes gaps = encode_gaps(block);
            gaps.insert(gaps.begin(), static_cast<std::uint8_t>(PairCodec::gap_symbols));
            seeds.write("pairs_fuzz", "packed_" + name, first(0), pack_pairs(block).stored);
            seeds.write("pairs_fuzz", "gaps_" + name, first(0), gaps);
            seeds.write("pairs_fuzz", "index_" + name, first(1), encode_counts(block));
        }
    seeds.write("pairs_fuzz", "clear", {5}, clear({2, 2, {0, 1, 1}, {1}, {3}}, {}));
    // A gap of 20 and a count of 18, both beyond a symbol.
    seeds.write("pairs_fuzz", "clear_large", {4}, clear({1, 30, {0, 1}, {20}, {18}}, {5, 3}));
}

void patches(const Seeds& seeds) {
    save_patches(seeds.path(), key, {{0x10}, {0.5}, {0, 1}, {{1, 2}}, {3, 4}, "ray"});
    seeds.write_file("patches_fuzz", "one");
    save_patches(seeds.path(), key, {{9, 3, 0, 4}, {1, 2, 0.25, 1e-9}, {0, 2, 2, 4}, {{1, 2}, {3, 4}}, {5, 6}, "hemicube"});
    seeds.write_file("patches_fuzz", "four");
}

void directory(const Seeds& seeds) {
    save_directory(seeds.path(), key,
                   {{{8, 8}, {0, 0}, {1, 2}, {0, 0}}, {{0, 0, 3, 40}, {0, 1, 1, 27}, {2, 2, 7, 60}}, 67});
    seeds.write_file("directory_fuzz", "three");
}

void atlas(const Seeds& seeds) {
    std::vector<Warning> warnings;
    save_atlas(seeds.path(), key, unwrap(two_boxes(), {}, warnings, {}));
    seeds.write_file("atlas_fuzz", "boxes");
}

void sky_view(const Seeds& seeds) {
    const auto write = [&](const std::string& name, std::uint64_t patches, std::uint32_t rays, const std::vector<SkyCounts>& blocks) {
        SkyViewWriter file(seeds.path(), key, patches, rays);
        for (const SkyCounts& block : blocks) file.append(block);
        file.publish();
        seeds.write_file("sky_view_fuzz", name);
    };
    const SkyCounts three{{2, 0, 1}, {5, 9, 1023}, {2, 1, 4}};
    write("none", 0, 64, {});
    write("three", 3, 4, {three});
    // A full block, of patches under cover but for one, and what is left.
    SkyCounts full;
    full.bins_of_patch.assign(sky_view_block, 0);
    full.bins_of_patch[1] = 1024;
    for (unsigned bin = 0; bin < 1024; ++bin) full.bins.push_back(static_cast<SkyBin>(bin)), full.counts.push_back(32);
    write("two_blocks", sky_view_block + 3, most_sky_rays, {full, three});
}

/// First byte as in stage_files_fuzz: the stage; second: three patches.
void stages(const Seeds& seeds) {
    const std::vector<Channels> channels{{1, 2, 3}, {0.5, 0, 1e30}, {4, 5, 6}};
    save_closure(seeds.path(), key, {{1, 2, 3}, {0.5, -1e-17, 0}, {0, 1, 2}, {7, 0.5, 0.25, 0, 0, 0.1, 0, 3, 0, 1, 1}});
    seeds.write_file("stage_files_fuzz", "closure", {0, 3});
    SolveResult result{"shoot", channels, channels, channels, 1e-4, true, 2.5, {{4096, 1}, {8192, 1e-4}}};
    save_solution(seeds.path(), key, result);
    seeds.write_file("stage_files_fuzz", "solution", {1, 3});
    save_plan(seeds.path(), key, {{{0, 6}, no_levels, {7, 20}}});
    seeds.write_file("stage_files_fuzz", "plan", {2, 3});
    save_accuracy(seeds.path(), key, {channels, channels, 0.125});
    seeds.write_file("stage_files_fuzz", "accuracy", {3, 3});
    save_page_light(seeds.path(), key, std::vector<TexelLight>{{{1, 2, 3}, {0, 0, 1}, 0.5f, 0.1f, 64}, {}, {{1e30f, 0.5f, 7}, {0, 0, 0}, 0, 0, 1}});
    seeds.write_file("stage_files_fuzz", "lightmap", {4, 3});
    save_checkpoint(seeds.path(), key, {"shoot", 8192, 1 << 20, result.history, {{1, 0.5, 1e30}, {}, {7}}});
    seeds.write_file("stage_files_fuzz", "checkpoint", {5, 3});
}

/// What is read by the module, but for WebP, which nothing here writes: the corpus has some.
void module_pictures(const Seeds& seeds) {
    constexpr std::uint32_t width = 11, height = 9;
    Bytes samples;
    for (std::uint32_t k = 0; k < 4 * width * height; ++k) samples.push_back(static_cast<std::uint8_t>(k * 77));
    seeds.write("image_module_fuzz", "runs.hdr", {}, encode_hdr(width, height, samples, {"irradiance", "lux", "rgbe", 1, "fuzz_seeds", {}}));
    seeds.write("image_module_fuzz", "plain.hdr", {}, encode_hdr(3, height, std::span(samples).first(4 * 3 * height), {"irradiance", "lux", "rgbe", 1, "fuzz_seeds", {}}));
    seeds.write("image_module_fuzz", "cmyk.jpg", {}, test::make_jpeg(width, height, test::JpegColour::cmyk, false, samples));
}

void pictures(const Seeds& seeds) {
    constexpr std::uint32_t width = 11, height = 9;
    const auto write = [&](const std::string& name, const Bytes& bytes) { seeds.write("image_fuzz", name, {}, bytes); };
    const auto samples = [](std::size_t channels, unsigned largest) {
        std::vector<std::uint16_t> values;
        for (unsigned k = 0; k < width * height * channels; ++k) values.push_back(static_cast<std::uint16_t>(k * 77 & largest));
        return values;
    };
    using test::PngColour;
    for (const bool is_interlaced : {false, true}) {
        const std::string kind = is_interlaced ? "_interlaced.png" : ".png";
        write("rgb_8" + kind, test::make_png({width, height, PngColour::rgb, 8, is_interlaced, samples(3, 255), {}, {}, {77, 154, 231}}));
        write("rgba_16" + kind, test::make_png({width, height, PngColour::rgba, 16, is_interlaced, samples(4, 65535), {}, {}, {}}));
        write("palette" + kind, test::make_png({width, height, PngColour::palette, 2, is_interlaced, samples(1, 3),
                                                {{1, 2, 3}, {40, 50, 60}, {70, 80, 90}, {255, 0, 7}}, {0, 100}, {}}));
        write("grey_1" + kind, test::make_png({width, height, PngColour::grey, 1, is_interlaced, samples(1, 1), {}, {}, {}}));
    }
    using test::JpegColour;
    for (const bool is_progressive : {false, true}) {
        const std::string kind = is_progressive ? "_progressive.jpg" : ".jpg";
        std::vector<std::uint8_t> bytes;
        for (const std::uint16_t value : samples(3, 255)) bytes.push_back(static_cast<std::uint8_t>(value));
        write("colour" + kind, test::make_jpeg(width, height, JpegColour::halved, is_progressive, bytes));
        bytes.resize(bytes.size() / 3);
        write("grey" + kind, test::make_jpeg(width, height, JpegColour::grey, is_progressive, bytes));
    }
    using test::ExrKind;
    std::vector<float> values;
    for (const std::uint16_t value : samples(4, 255)) values.push_back(static_cast<float>(value) / 16);
    const auto part = [&](const char* name, std::uint32_t tile, bool has_levels) {
        return test::ExrSamplePart{name, {{"R", ExrKind::half_float}, {"G", ExrKind::float_32}, {"B", ExrKind::half_float}, {"id", ExrKind::uint_32}},
                                   3, -4, tile, tile, has_levels, values};
    };
    write("lines.exr", test::make_exr(width, height, {part("", 0, false)}));
    write("tiles.exr", test::make_exr(width, height, {part("", 4, false)}));
    write("levels.exr", test::make_exr(width, height, {part("", 4, true)}));
    write("parts.exr", test::make_exr(width, height, {part("a", 4, false), part("b", 0, false)}));
}

}  // namespace
}  // namespace luxel::fuzz

int main(int count, char** arguments) {
    if (count != 2) {
        std::fprintf(stderr, "usage: fuzz_seeds FOLDER\n");
        return 1;
    }
    const luxel::fuzz::Seeds seeds(arguments[1]);
    luxel::fuzz::evidence(seeds);
    luxel::fuzz::strips(seeds);
    luxel::fuzz::pairs(seeds);
    luxel::fuzz::patches(seeds);
    luxel::fuzz::directory(seeds);
    luxel::fuzz::atlas(seeds);
    luxel::fuzz::sky_view(seeds);
    luxel::fuzz::stages(seeds);
    luxel::fuzz::pictures(seeds);
    luxel::fuzz::module_pictures(seeds);
    for (const auto& [name, bytes] : luxel::fuzz::gltf_seeds()) seeds.write("gltf_fuzz", name + ".glb", {}, bytes);
    for (const auto& [name, bytes] : luxel::fuzz::draco_seeds()) seeds.write("draco_fuzz", name, {}, bytes);
    for (const auto& [name, bytes] : luxel::fuzz::meshopt_seeds()) seeds.write("meshopt_fuzz", name, {}, bytes);
    return 0;
}
