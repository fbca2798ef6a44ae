#include "mien/datasets/coefficient_folder.h"

#include <algorithm>
#include <optional>
#include <tuple>

#include "mien/base/number_text.h"
#include "mien/core/arkit.h"
#include "mien/datasets/layout.h"
#include "mien/io/motion_file.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kStart = "sentence";

std::optional<CoefficientFile> parse(const fs::path& path, std::string person) {
  if (path.extension() != ".csv") return std::nullopt;
  const std::string stem = path.stem().string();
  if (!stem.starts_with(kStart)) return std::nullopt;
  const auto hyphen = stem.find('-');
  const auto number = parse_int(std::string_view(stem).substr(
      kStart.size(), hyphen == std::string::npos ? hyphen : hyphen - kStart.size()));
  if (!number || *number < 0 || *number > 1'000'000) return std::nullopt;
  return CoefficientFile{std::move(person), static_cast<int>(*number),
                         hyphen == std::string::npos ? "" : stem.substr(hyphen + 1), path};
}

auto order_of(const CoefficientFile& file) {
  const auto number = parse_int(file.repetition);
  return std::tuple(file.person, file.sentence, !file.repetition.empty(), !number.has_value(),
                    number.value_or(0), file.repetition);
}

Status list(const fs::path& folder, const std::string& person, std::vector<CoefficientFile>& files,
            std::int64_t& num_strange) {
  std::error_code ec;
  fs::directory_iterator entries(folder, ec);
  if (ec) return Error{Errc::input, "'" + folder.string() + "'", "cannot be listed: " + ec.message(), ""};
  for (const auto& entry : entries) {
    if (entry.is_directory(ec) && person.empty()) {
      MIEN_TRY([[maybe_unused]] const auto listed,
               list(entry.path(), entry.path().filename().string(), files, num_strange));
    } else if (auto file = parse(entry.path(), person)) {
      files.push_back(std::move(*file));
    } else if (entry.path().extension() == ".csv") {
      ++num_strange;
    }
  }
  return Done{};
}

}  // namespace

Result<std::vector<CoefficientFile>> list_coefficients(const fs::path& folder) {
  std::vector<CoefficientFile> files;
  std::int64_t num_strange = 0;
  MIEN_TRY([[maybe_unused]] const auto listed, list(folder, "", files, num_strange));
  if (files.empty())
    return Error{Errc::input, "'" + folder.string() + "'", "holds no coefficients of a sentence",
                 "Expected are files such as FaceTalk_170731_00024_TA/sentence01.csv"};
  std::ranges::sort(files, {}, order_of);
  Result<std::vector<CoefficientFile>> result(std::move(files));
  if (num_strange > 0)
    result.warnings.push_back("'" + folder.string() + "': " + std::to_string(num_strange) +
                              " .csv files are not named sentenceNN and are left out");
  return result;
}

Result<Motion> read_coefficients(const fs::path& path) {
  auto read = read_motion(path);
  if (!read) return read.error();
  const Motion& all = *read;
  const auto fail = [&](std::string why, std::string fix) {
    return Error{Errc::incompatible, "'" + path.string() + "'", std::move(why), std::move(fix)};
  };
  if (all.fps != kCoefficientFps)
    return fail(
        "has " + shortest(static_cast<float>(all.fps)) + " frames a second, SAiD's coefficients have 60", "");
  Motion motion{MotionSpace::arkit, arkit_order(ArkitOrder::said), all.fps, {}};
  std::vector<std::size_t> columns;
  std::string missing;
  for (const auto& name : motion.channels) {
    const auto found = std::ranges::find(all.channels, name);
    if (found == all.channels.end()) missing += (missing.empty() ? "" : ", ") + name;
    columns.push_back(static_cast<std::size_t>(found - all.channels.begin()));
  }
  if (!missing.empty())
    return fail("has no column " + missing, "SAiD's measures need all of its 32 coefficients");
  motion.values.reserve(static_cast<std::size_t>(all.num_frames()) * columns.size());
  for (std::int64_t n = 0; n < all.num_frames(); ++n)
    for (const std::size_t c : columns) motion.values.push_back(all.frame(n)[c]);
  Result<Motion> result(std::move(motion));
  result.warnings = std::move(read.warnings);
  return result;
}

std::string_view coefficient_split(std::string_view person) {
  // VOCASET validates and tests on sentences 21 to 40; the persons are the same.
  const SequenceName name{std::string(person), 21, -1};
  return split_of(DatasetKind::vocaset, name).value_or("");
}

}  // namespace mien
