// mien data: what a data set lacks, and recordings brought into the form that training reads.
#include "data_command.h"

#include <memory>
#include <optional>

#include "corpus_data.h"
#include "facts.h"
#include "mien/base/number_text.h"
#include "mien/console/console_exit.h"
#include "mien/datasets/check.h"
#include "mien/datasets/prepare.h"
#include "options.h"
#include "printing.h"

namespace mien {
namespace {

struct DataArguments {
  std::string folder, layout, output, templates, mesh, drop_vertices, scaler;
  bool read_values = false, json = false;
};

std::string layout_list() {
  std::string list;
  for (const auto name : dataset_names()) list += (list.empty() ? "" : ", ") + std::string(name);
  return list;
}

Result<std::optional<DatasetKind>> chosen_layout(const DataArguments& a) {
  if (a.layout.empty()) return std::optional<DatasetKind>();
  const auto kind = parse_dataset_kind(a.layout);
  if (!kind)
    return Error{Errc::usage, "--layout '" + a.layout + "'", "is no data set that Mien knows",
                 "Choose one of: " + layout_list()};
  return kind;
}

Facts facts_of(const Dataset& dataset, const DatasetReport& report) {
  const DatasetLayout& layout = *dataset.layout;
  Facts facts;
  facts.add("kind", "data set");
  facts.add("folder", dataset.folder.string());
  facts.add("layout", layout.name);
  facts.add("fps", layout.fps, 0);
  facts.add("numbers_in_a_frame", layout.width);
  facts.add("sequences", static_cast<std::int64_t>(dataset.sequences.size()));
  facts.add("templates", static_cast<std::int64_t>(dataset.templates.size()));
  std::string text, json;
  for (const auto& split : report.splits) {
    text += "  " + split.split + ": " + std::to_string(split.found) +
            (split.expected > 0 ? " of " + std::to_string(split.expected) : "") + " sequences, " +
            std::to_string(split.num_frames) + " stored frames\n";
    json += (json.empty() ? "{\"name\":" : ",{\"name\":") + json_string(split.split) +
            ",\"sequences\":" + std::to_string(split.found) +
            ",\"expected\":" + std::to_string(split.expected) +
            ",\"frames\":" + std::to_string(split.num_frames) + "}";
  }
  facts.add_table("splits", std::move(text), "[" + json + "]");
  const auto add_list = [&](const char* name, const std::vector<std::string>& lines) {
    std::string list, array;
    for (const auto& line : lines) {
      list += "  " + line + "\n";
      array += (array.empty() ? "" : ",") + json_string(line);
    }
    facts.add_table(name, lines.empty() ? "  none\n" : list, "[" + array + "]");
  };
  add_list("problems", report.problems);
  add_list("oddities", report.oddities);
  return facts;
}

Status run_check(const DataArguments& a, ConsoleProgress& progress) {
  MIEN_TRY(const auto kind, chosen_layout(a));
  MIEN_TRY(const Dataset dataset, open_dataset(a.folder, kind));
  MIEN_TRY(const DatasetReport report, check_dataset(dataset, {.read_values = a.read_values}, progress));
  progress.finish_line();
  const Facts facts = facts_of(dataset, report);
  MIEN_TRY([[maybe_unused]] const auto printed, print(a.json ? facts.to_json() : facts.to_text()));
  if (!report.problems.empty())
    return Error{Errc::input, "data set '" + a.folder + "'",
                 "has " + std::to_string(report.problems.size()) +
                     (report.problems.size() == 1 ? " problem" : " problems"),
                 ""};
  return Done{};
}

Result<PrepareReport> prepared(const DataArguments& a, DatasetKind kind, Progress& progress) {
  if (!is_corpus(a.folder))
    return prepare_dataset(
        kind, a.folder, a.output,
        {.templates = a.templates, .mesh = a.mesh, .drop_vertices = a.drop_vertices, .scaler = a.scaler},
        progress);
  if (kind != DatasetKind::beat)
    return Error{Errc::usage, "--layout '" + a.layout + "'",
                 "is no layout that a synthetic corpus can be brought into", "Choose beat"};
  return prepare_corpus(a.folder, a.output, progress);
}

Status run_prepare(const DataArguments& a, ConsoleProgress& progress) {
  MIEN_TRY(const auto kind, chosen_layout(a));
  progress.event("start", "\"command\":\"data prepare\",\"input\":" + json_string(a.folder) +
                              ",\"outputs\":[" + json_string(a.output) + "]");
  const auto report = prepared(a, *kind, progress);
  if (!report) return report.error();
  for (const auto& warning : report.warnings) progress.warn(warning);
  const std::string sequences = std::to_string(report->num_sequences),
                    frames = std::to_string(report->num_frames);
  progress.event("success", "\"outputs\":[" + json_string(a.output) + "],\"sequences\":" + sequences +
                                ",\"frames\":" + frames);
  progress.say("wrote " + a.output + ": " + sequences + " sequences, " + frames + " frames");
  return Done{};
}

}  // namespace

void add_data_command(CLI::App& program, Chosen& chosen) {
  auto* command = program.add_subcommand("data", "Check and prepare the data sets of the papers");
  command->require_subcommand(1);
  const std::string layouts = "Which data set: " + layout_list();

  auto* check = command->add_subcommand("check", "Tell what is missing or odd in a prepared data set");
  auto c = std::make_shared<DataArguments>();
  check->add_option("FOLDER", c->folder, "Folder with wav/ and vertices_npy/ (or param/), and templates.pkl")
      ->required();
  check->add_option("--layout", c->layout, layouts + ". Default: told by the folder and its names");
  check->add_flag("--read-values", c->read_values, "Look at every number of every motion");
  check->add_flag("--quiet", chosen.quiet, "Print no progress");
  check->add_flag("--json", chosen.json, "Print one JSON object on standard output, progress as JSON lines");
  add_footer(*check,
             "  mien data check data/BIWI\n  mien data check data/BIWI --layout biwi-expressive --json\n");
  check->callback([c, &chosen] {
    c->json = chosen.json;
    chosen.work = [c](ConsoleProgress& progress) { return run_check(*c, progress); };
  });

  auto* prepare = command->add_subcommand("prepare", "Bring recordings into the form that training reads");
  auto p = std::make_shared<DataArguments>();
  prepare
      ->add_option(
          "RAW", p->folder,
          "Folder of the recordings as their makers deliver them, or a synthetic corpus (--layout beat)")
      ->required();
  prepare->add_option("--layout", p->layout, layouts)->required();
  prepare->add_option("-o,--output", p->output, "Folder to write")->required();
  prepare->add_option(
      "--templates", p->templates,
      "biwi-expressive, multiface: unscaled templates (templates_orig.pkl); vocaset: its templates");
  prepare->add_option("--mesh", p->mesh, "biwi: a mesh with the triangles (.obj .ply)");
  prepare->add_option("--drop-vertices", p->drop_vertices,
                      "multiface: text file with the vertices to leave out");
  prepare->add_option("--scaler", p->scaler,
                      "uudamm: the published scaler.pkl. Default: the recordings' own ranges");
  add_console_options(*prepare, chosen);
  add_footer(
      *prepare,
      "  mien data prepare BIWI/raw --layout biwi-expressive --templates templates_orig.pkl -o data/BIWI\n"
      "  mien data prepare VOCASET/trainingdata --layout vocaset -o data/vocaset\n"
      "  mien data prepare corpus --layout beat -o data/BEAT-synthetic\n");
  prepare->callback(
      [p, &chosen] { chosen.work = [p](ConsoleProgress& progress) { return run_prepare(*p, progress); }; });
}

}  // namespace mien
