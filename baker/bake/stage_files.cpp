#include "baker/bake/stage_files.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace luxel {
namespace {

constexpr std::uint32_t version = 1;
constexpr std::uint32_t checkpoint_version = 2, lightmap_version = 2;
/// Numbers of a checkpoint's vectors in one block: compressing a block takes as much memory again.
constexpr std::size_t piece_numbers = std::size_t{1} << 16;
/// A double holds every whole number up to here.
constexpr double most_whole = 9007199254740992.0;

[[noreturn]] void damaged(const BlockFileReader& file, const std::string& what) {
    throw Error(ErrorCode::damaged_store, file.name(), what, "remove the file and run the same command again");
}

void check_size(const BlockFileReader& file, std::size_t found, std::size_t expected, const char* column) {
    if (found != expected)
        damaged(file, std::string("column ") + column + " has " + std::to_string(found) + " numbers, expected " +
                          std::to_string(expected));
}

/// Column `index`: `count` finite numbers.
template <class T>
std::vector<T> finite_column(const BlockFileReader& file, std::size_t index, std::size_t count, const char* column) {
    std::vector<T> values = read_column<T>(file, index);
    check_size(file, values.size(), count, column);
    for (std::size_t k = 0; k < count; ++k)
        if (!std::isfinite(values[k]))
            damaged(file, std::string("column ") + column + ": number " + std::to_string(k) + " is not finite");
    return values;
}

/// A count that is stored as a double.
std::uint64_t whole(const BlockFileReader& file, double value, double most, const char* column) {
    if (std::signbit(value) || !(value <= most) || value != std::floor(value))
        damaged(file, std::string("column ") + column + ": " + std::to_string(value) + " is not a count");
    return static_cast<std::uint64_t>(value);
}

/// A bound of the error: infinite before there is one.
double bound(const BlockFileReader& file, double value) {
    if (!(value >= 0)) damaged(file, "an error bound of " + std::to_string(value));
    return value;
}

std::vector<double> flat(const std::vector<Channels>& values) {
    std::vector<double> all;
    all.reserve(values.size() * 3);
    for (const Channels& value : values) all.insert(all.end(), value.begin(), value.end());
    return all;
}

std::vector<Channels> channels(const std::vector<double>& values) {
    std::vector<Channels> all(values.size() / 3);
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = {values[3 * k], values[3 * k + 1], values[3 * k + 2]};
    return all;
}

/// `size` numbers from block `next` on, as many blocks as they fill; `next` is the block after them then.
std::vector<double> read_pieces(const BlockFileReader& file, std::size_t& next, std::uint64_t size) {
    std::vector<double> numbers;
    // A size that is a lie must not ask for memory: numbers of a solve hardly compress.
    numbers.reserve(std::min(size, file.file_bytes()));
    while (numbers.size() < size) {
        if (next == file.blocks().size()) damaged(file, "vectors end before their " + std::to_string(size) + " numbers");
        const std::vector<double> piece = read_column<double>(file, next++);
        check_size(file, piece.size(), std::min<std::uint64_t>(piece_numbers, size - numbers.size()), "of a vector");
        for (const double number : piece)
            if (std::isnan(number)) damaged(file, "block " + std::to_string(next - 1) + " holds what is not a number");
        numbers.insert(numbers.end(), piece.begin(), piece.end());
    }
    return numbers;
}

ByteView text_bytes(const std::string& text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

bool absent(const std::filesystem::path& path) {
    std::error_code ignored;
    return !std::filesystem::exists(path, ignored);
}

/// Column `index`, a colour for each of `count` texels: calls read(k, colour).
template <class Read>
void read_colours(const BlockFileReader& file, std::size_t index, std::size_t count, const char* column, const Read& read) {
    const auto values = finite_column<float>(file, index, 3 * count, column);
    for (std::size_t k = 0; k < count; ++k) read(k, Rgb(values[3 * k], values[3 * k + 1], values[3 * k + 2]));
}

}  // namespace

void save_plan(const std::filesystem::path& path, const Key& key, const LevelPlan& plan) {
    std::vector<std::uint8_t> first, last;
    for (const LevelRange& levels : plan.levels) {
        first.push_back(levels.first);
        last.push_back(levels.last);
    }
    BlockFileWriter file(path, FileKind::plan, version, key);
    append_column<std::uint8_t>(file, 0, first);
    append_column<std::uint8_t>(file, 1, last);
    file.publish();
}

std::optional<LevelPlan> load_plan(const std::filesystem::path& path, const Key& key, std::size_t patch_count) {
    if (absent(path)) return {};
    const BlockFileReader file(path, FileKind::plan, version, &key);
    require_numbered_blocks(file, 2);
    const auto first = read_column<std::uint8_t>(file, 0), last = read_column<std::uint8_t>(file, 1);
    check_size(file, first.size(), patch_count, "first");
    check_size(file, last.size(), patch_count, "last");
    LevelPlan plan;
    for (std::size_t p = 0; p < patch_count; ++p) {
        if (last[p] > highest_level || first[p] > last[p] + 1)
            damaged(file, "levels of patch " + std::to_string(p) + " are out of order");
        plan.levels.push_back({first[p], last[p]});
    }
    return plan;
}

void save_closure(const std::filesystem::path& path, const Key& key, const Closure& closure) {
    BlockFileWriter file(path, FileKind::closure, version, key);
    append_column<double>(file, 0, closure.mu);
    append_column<double>(file, 1, closure.diagonal_m2);
    append_column<double>(file, 2, closure.row_open_m2);
    const ClosureReport& r = closure.report;
    const std::vector<double> report{static_cast<double>(r.iterations), r.max_row_error_before, r.mean_row_error_before,
                                     r.max_row_error_after, r.mean_row_error_after, r.diagonal_share, r.remainder_share,
                                     static_cast<double>(r.short_rows), r.short_share, r.largest_change, r.mean_change};
    append_column<double>(file, 3, report);
    file.publish();
}

std::optional<Closure> load_closure(const std::filesystem::path& path, const Key& key, std::size_t patch_count) {
    if (absent(path)) return {};
    const BlockFileReader file(path, FileKind::closure, version, &key);
    require_numbered_blocks(file, 4);
    Closure closure;
    closure.mu = finite_column<double>(file, 0, patch_count, "mu");
    if (std::any_of(closure.mu.begin(), closure.mu.end(), [](double mu) { return mu < 0; }))
        damaged(file, "a negative mu");
    closure.diagonal_m2 = finite_column<double>(file, 1, patch_count, "diagonal");
    closure.row_open_m2 = finite_column<double>(file, 2, patch_count, "open");
    const auto report = finite_column<double>(file, 3, 11, "report");
    closure.report = {static_cast<std::uint32_t>(whole(file, report[0], 0xffffffff, "report")), report[1], report[2],
                      report[3], report[4], report[5], report[6], whole(file, report[7], most_whole, "report"),
                      report[8], report[9], report[10]};
    return closure;
}

void save_solution(const std::filesystem::path& path, const Key& key, const SolveResult& result) {
    BlockFileWriter file(path, FileKind::solution, version, key);
    append_column<double>(file, 0, flat(result.radiosity));
    append_column<double>(file, 1, flat(result.unshot));
    const std::vector<double> report{result.error_bound, result.reads, result.converged ? 1.0 : 0.0};
    append_column<double>(file, 2, report);
    std::vector<double> history;
    for (const SolveStep& step : result.history) {
        history.push_back(static_cast<double>(step.bytes_read));
        history.push_back(step.error_bound);
    }
    append_column<double>(file, 3, history);
    file.append(4, text_bytes(result.solver), 0);
    append_column<double>(file, 5, flat(result.irradiance));
    file.publish();
}

std::optional<SolveResult> load_solution(const std::filesystem::path& path, const Key& key, std::size_t patch_count) {
    if (absent(path)) return {};
    const BlockFileReader file(path, FileKind::solution, version, &key);
    require_numbered_blocks(file, 6);
    SolveResult result;
    result.radiosity = channels(finite_column<double>(file, 0, 3 * patch_count, "radiosity"));
    result.unshot = channels(finite_column<double>(file, 1, 3 * patch_count, "unshot"));
    result.irradiance = channels(finite_column<double>(file, 5, 3 * patch_count, "irradiance"));
    const auto report = read_column<double>(file, 2), history = read_column<double>(file, 3);
    check_size(file, report.size(), 3, "report");
    check_size(file, history.size() % 2, 0, "history");
    result.error_bound = bound(file, report[0]);
    result.reads = report[1];
    if (!(result.reads >= 0 && std::isfinite(result.reads))) damaged(file, "reads of " + std::to_string(result.reads));
    result.converged = whole(file, report[2], 1, "report") != 0;
    for (std::size_t k = 0; k < history.size(); k += 2)
        result.history.push_back({whole(file, history[k], most_whole, "history"), bound(file, history[k + 1])});
    result.solver = read_name(file, 4);
    return result;
}

void save_checkpoint(const std::filesystem::path& path, const Key& key, const SolveState& state) {
    BlockFileWriter file(path, FileKind::checkpoint, checkpoint_version, key);
    file.append(0, text_bytes(state.solver), 0);
    append_column<std::uint64_t>(file, 1, std::array{state.bytes_read, state.requested_bytes});
    std::vector<std::uint64_t> bytes;
    std::vector<double> bounds;
    for (const SolveStep& step : state.history) {
        bytes.push_back(step.bytes_read);
        bounds.push_back(step.error_bound);
    }
    append_column<std::uint64_t>(file, 2, bytes);
    append_column<double>(file, 3, bounds);
    std::vector<std::uint64_t> sizes;
    for (const auto& numbers : state.numbers) sizes.push_back(numbers.size());
    append_column<std::uint64_t>(file, 4, sizes);
    for (const auto& numbers : state.numbers)
        for (std::size_t begin = 0; begin < numbers.size(); begin += piece_numbers)
            append_column<double>(file, file.block_count(),
                                  std::span(numbers).subspan(begin, std::min(piece_numbers, numbers.size() - begin)));
    file.publish();
}

std::optional<SolveState> load_checkpoint(const std::filesystem::path& path, const Key& key) {
    if (absent(path) || identify_block_file(path).version != checkpoint_version) return {};
    const BlockFileReader file(path, FileKind::checkpoint, checkpoint_version, &key);
    constexpr std::size_t first_piece = 5;
    require_numbered_blocks(file, std::max(file.blocks().size(), first_piece));
    SolveState state;
    state.solver = read_name(file, 0);
    const auto counts = read_column<std::uint64_t>(file, 1), bytes = read_column<std::uint64_t>(file, 2);
    const auto bounds = read_column<double>(file, 3);
    check_size(file, counts.size(), 2, "bytes");
    check_size(file, bounds.size(), bytes.size(), "history");
    state.bytes_read = counts[0], state.requested_bytes = counts[1];
    for (std::size_t k = 0; k < bytes.size(); ++k) state.history.push_back({bytes[k], bound(file, bounds[k])});
    std::size_t next = first_piece;
    for (const std::uint64_t size : read_column<std::uint64_t>(file, 4)) state.numbers.push_back(read_pieces(file, next, size));
    check_size(file, file.blocks().size(), next, "of vectors");
    return state;
}

void save_accuracy(const std::filesystem::path& path, const Key& key, const StandardError& error) {
    BlockFileWriter file(path, FileKind::accuracy, version, key);
    append_column<double>(file, 0, flat(error.radiosity));
    append_column<double>(file, 1, flat(error.irradiance));
    append_column<double>(file, 2, std::vector<double>{error.relative});
    file.publish();
}

std::optional<StandardError> load_accuracy(const std::filesystem::path& path, const Key& key, std::size_t patch_count) {
    if (absent(path)) return {};
    const BlockFileReader file(path, FileKind::accuracy, version, &key);
    require_numbered_blocks(file, 3);
    const auto radiosity = finite_column<double>(file, 0, 3 * patch_count, "radiosity");
    const auto irradiance = finite_column<double>(file, 1, 3 * patch_count, "irradiance");
    const auto relative = finite_column<double>(file, 2, 1, "relative");
    return StandardError{channels(radiosity), channels(irradiance), relative[0]};
}

void save_page_light(const std::filesystem::path& path, const Key& key, std::span<const TexelLight> light) {
    BlockFileWriter file(path, FileKind::lightmap, lightmap_version, key);
    std::vector<float> values;
    for (const Rgb TexelLight::*part : {&TexelLight::direct, &TexelLight::indirect}) {
        values.clear();
        for (const TexelLight& texel : light)
            for (int c = 0; c < 3; ++c) values.push_back((texel.*part)[c]);
        append_column<float>(file, part == &TexelLight::direct ? 0 : 1, values);
    }
    values.clear();
    std::vector<std::uint32_t> rays;
    for (const TexelLight& texel : light) values.push_back(texel.error), rays.push_back(texel.rays);
    append_column<float>(file, 2, values);
    append_column<std::uint32_t>(file, 3, rays);
    values.clear();
    for (const TexelLight& texel : light) values.push_back(texel.bias);
    append_column<float>(file, 4, values);
    file.publish();
}

std::optional<std::vector<TexelLight>> load_page_light(const std::filesystem::path& path, const Key& key, std::size_t texel_count) {
    if (absent(path)) return {};
    const BlockFileReader file(path, FileKind::lightmap, lightmap_version, &key);
    require_numbered_blocks(file, 5);
    std::vector<TexelLight> light(texel_count);
    read_colours(file, 0, texel_count, "direct", [&](std::size_t k, const Rgb& value) { light[k].direct = value; });
    read_colours(file, 1, texel_count, "indirect", [&](std::size_t k, const Rgb& value) { light[k].indirect = value; });
    const auto errors = finite_column<float>(file, 2, texel_count, "error");
    const auto rays = read_column<std::uint32_t>(file, 3);
    check_size(file, rays.size(), texel_count, "rays");
    const auto biases = finite_column<float>(file, 4, texel_count, "sharing");
    for (std::size_t k = 0; k < texel_count; ++k) light[k].error = errors[k], light[k].rays = rays[k], light[k].bias = biases[k];
    return light;
}

std::optional<std::vector<Rgb>> load_page_irradiance(const std::filesystem::path& path, const Key& key, std::size_t texel_count) {
    if (absent(path)) return {};
    const BlockFileReader file(path, FileKind::lightmap, lightmap_version, &key);
    require_numbered_blocks(file, 5);
    std::vector<Rgb> sum(texel_count, Rgb(0, 0, 0));
    read_colours(file, 0, texel_count, "direct", [&](std::size_t k, const Rgb& value) { sum[k] = value; });
    read_colours(file, 1, texel_count, "indirect", [&](std::size_t k, const Rgb& value) { sum[k] += value; });
    return sum;
}

}  // namespace luxel
