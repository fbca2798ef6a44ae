#include "training_config.h"

#define TOML_EXCEPTIONS 0
#include <toml++/toml.h>

#include <set>

#include "mien/base/file.h"

namespace mien::train {
namespace {

// Reads fields of one table, and complains about wrong types and about fields that nobody asked for.
class TableReader {
 public:
  TableReader(const toml::table& root, const char* name, std::string& problems)
      : name_(name), table_(root[name].as_table()), problems_(problems) {
    if (root.contains(name) && table_ == nullptr) problems_ += "[" + name_ + "] is not a table; ";
  }
  ~TableReader() {
    if (table_ == nullptr) return;
    for (const auto& [key, node] : *table_)
      if (!known_.contains(std::string(key.str())))
        problems_ += "line " + std::to_string(node.source().begin.line) + ": unknown field '" +
                     std::string(key.str()) + "' in [" + name_ + "]; ";
  }
  TableReader(const TableReader&) = delete;
  TableReader& operator=(const TableReader&) = delete;

  template <class T>
  void read(const char* key, T& value) {
    known_.insert(key);
    if (table_ == nullptr || !table_->contains(key)) return;
    const auto node = (*table_)[key];
    if constexpr (std::is_integral_v<T>) {
      if (const auto v = node.template value_exact<std::int64_t>()) return void(value = static_cast<T>(*v));
    } else if constexpr (std::is_floating_point_v<T>) {
      if (const auto v = node.template value<double>()) return void(value = *v);
    } else {
      if (const auto v = node.template value_exact<std::string>()) return void(value = *v);
    }
    problems_ += "line " + std::to_string(node.node()->source().begin.line) + ": '" + std::string(key) +
                 "' has the wrong type; ";
  }

 private:
  std::string name_;
  const toml::table* table_;
  std::string& problems_;
  std::set<std::string> known_;
};

void read_stage(const toml::table& root, const char* name, std::string& problems, StageOptions& stage,
                const std::function<void(TableReader&)>& extra) {
  TableReader t(root, name, problems);
  t.read("steps", stage.num_steps);
  t.read("learning_rate", stage.learning_rate);
  t.read("warm_up_steps", stage.warm_up_steps);
  t.read("weight_decay", stage.weight_decay);
  t.read("clip_norm", stage.clip_norm);
  t.read("average_decay", stage.average_decay);
  t.read("checkpoint_every", stage.checkpoint_every);
  extra(t);
}

}  // namespace

Result<TrainingConfig> load_training_config(const std::filesystem::path& path) {
  MIEN_TRY(const auto bytes, read_file(path));
  TrainingConfig config;
  config.text = as_text(bytes);
  const toml::parse_result parsed = toml::parse(config.text);
  if (!parsed)
    return Error{Errc::usage,
                 "'" + path.string() + "' line " + std::to_string(parsed.error().source().begin.line),
                 std::string(parsed.error().description()), ""};
  const toml::table& root = parsed.table();
  std::string problems;
  auto& o = config.options;
  {
    TableReader t(root, "run", problems);
    std::string data, output, work;
    std::int64_t seed = 1;
    t.read("name", config.name);
    t.read("data", data);
    t.read("output", output);
    t.read("work_folder", work);
    t.read("seed", seed);
    t.read("threads", config.num_threads);
    config.data = data, config.output = output, config.work_folder = work;
    o.seed = static_cast<std::uint64_t>(seed);
    if (data.empty() || output.empty() || work.empty())
      problems += "[run] needs data, output and work_folder; ";
  }
  {
    TableReader t(root, "model", problems);
    t.read("width", config.sizes.width);
    t.read("condition", config.sizes.condition);
    t.read("diffusion_hidden", config.sizes.diffusion_hidden);
    t.read("blink_hidden", config.sizes.blink_hidden);
    t.read("brow_hidden", config.sizes.brow_hidden);
    t.read("look_ahead_mel_frames", o.look_ahead_mel_frames);
  }
  read_stage(root, "mean", problems, config.mean, [&](TableReader& t) {
    t.read("batch", o.mean_batch);
    t.read("crop_frames", o.crop_frames);
    t.read("level_offset_sd_db", o.level_offset_sd_db);
    t.read("difference_weight", o.difference_weight);
    t.read("aperture_weight", o.aperture_weight);
    t.read("upper_weight", o.upper_weight);
    t.read("viseme_weight", o.viseme_weight);
    t.read("event_weight", o.event_weight);
    t.read("unknown_probability", o.unknown_probability);
  });
  read_stage(root, "diffusion", problems, config.diffusion, [&](TableReader& t) {
    t.read("batch", o.sequence_batch);
    t.read("sequence_chunks", o.sequence_chunks);
    t.read("times_per_chunk", o.times_per_chunk);
    t.read("history_noise", o.history_noise);
    t.read("max_snr_weight", o.max_snr_weight);
  });
  read_stage(root, "blink", problems, config.blink, [](TableReader&) {});
  read_stage(root, "brow", problems, config.brow, [](TableReader&) {});
  if (o.crop_frames % 3 != 0) problems += "[mean] crop_frames must be a multiple of 3; ";
  if (!problems.empty())
    return Error{Errc::usage, "'" + path.string() + "'", problems, "See configs/default.toml"};
  return config;
}

}  // namespace mien::train
