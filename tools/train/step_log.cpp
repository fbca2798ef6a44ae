#include "step_log.h"

#include <optional>
#include <string_view>
#include <system_error>

#include "mien/base/number_text.h"

namespace mien::train {
namespace {

// "stage<tab>step<tab>..." -> step, when the line is of that stage.
std::optional<std::int64_t> step_of(std::string_view line, std::string_view stage) {
  if (!line.starts_with(stage) || line.size() <= stage.size() || line[stage.size()] != '\t')
    return std::nullopt;
  const std::string_view rest = line.substr(stage.size() + 1);
  return parse_int(rest.substr(0, rest.find('\t')));
}

}  // namespace

void StepLog::begin(std::string stage) {
  stage_ = std::move(stage);
  file_.close();
}

Status StepLog::forget_from(std::int64_t step) {
  std::uintmax_t kept = 0;
  std::ifstream old(path_, std::ios::binary);
  for (std::string line; std::getline(old, line) && !old.eof(); kept += line.size() + 1)
    if (const auto found = step_of(line, stage_); found && *found >= step) break;
  if (!old.is_open()) return Done{};  // the first run
  std::error_code ec;
  std::filesystem::resize_file(path_, kept, ec);
  if (ec) return Error{Errc::failed, "'" + path_.string() + "'", "cannot be written: " + ec.message(), ""};
  return Done{};
}

Status StepLog::add(std::int64_t step, double loss, double learning_rate, double gradient_norm) {
  if (!file_.is_open()) {
    MIEN_TRY([[maybe_unused]] const auto cut, forget_from(step));
    file_.clear();
    file_.open(path_, std::ios::app);
  }
  file_ << stage_ << '\t' << step << '\t' << shortest(static_cast<float>(loss)) << '\t'
        << shortest(static_cast<float>(learning_rate)) << '\t' << shortest(static_cast<float>(gradient_norm))
        << '\n'
        << std::flush;
  if (!file_) return Error{Errc::failed, "'" + path_.string() + "'", "writing failed (disk full?)", ""};
  return Done{};
}

}  // namespace mien::train
