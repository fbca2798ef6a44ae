// mien fit: coefficients of a character from sequences of its vertices.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>

#include "character_source.h"
#include "fit_input.h"
#include "fit_report.h"
#include "flame_rig.h"
#include "mien/base/file.h"
#include "mien/base/number_text.h"
#include "mien/base/parallel.h"
#include "mien/console/console_exit.h"
#include "mien/face/pose.h"
#include "mien/io/character_file.h"
#include "mien/io/flame_file.h"
#include "mien/io/gltf_writer.h"
#include "mien/io/motion_file.h"
#include "options.h"
#include "outputs.h"
#include "person_faces.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

constexpr double kCurvesFps = 60, kFlameFps = 25;  // of what is written, where nothing else is said

struct FitArguments {
  std::string input, output, character, person_shapes, templates, shapes, vertices, format = ".csv",
                                                                                    residuals, flame;
  double fps = 0, max_change = 0.1, mm_per_unit = 0;
  std::optional<double> to_fps;
  std::int64_t expressions = 0;
  int threads = hardware_threads();
  bool force = false, json = false;
};

// One sequence to fit and where its coefficients go.
struct Task {
  fs::path input, output;
  std::string person;  // whose face it is, where persons have shapes of their own
};

// In a folder: <sequence>.csv, or <person>/sentence07.csv as SAiD's programs have it.
fs::path place_of(const Task& task, const std::string& format) {
  const std::string name = task.input.stem().string();
  if (task.person.empty()) return name + format;
  const bool begins = name.starts_with(task.person + "_");
  return fs::path(task.person) / ((begins ? name.substr(task.person.size() + 1) : name) + format);
}

Result<std::vector<Task>> plan_tasks(const FitArguments& a, const std::vector<fs::path>& sequences,
                                     const std::optional<PersonFaces>& persons) {
  const bool is_folder = a.output.ends_with('/');
  if (sequences.size() > 1 && !is_folder)
    return Error{Errc::usage, "output '" + a.output + "'",
                 "'" + a.input + "' holds " + std::to_string(sequences.size()) + " sequences",
                 "Write into a folder: " + a.output + "/"};
  std::vector<Task> tasks;
  for (const fs::path& input : sequences) {
    Task task{input, a.output, {}};
    if (persons) {
      MIEN_TRY(task.person, persons->person_of(input));
    }
    if (is_folder) task.output = fs::path(a.output) / place_of(task, a.format);
    tasks.push_back(std::move(task));
  }
  return tasks;
}

// Characters are in metres, and so are sequences of which nothing else is known.
double mm_per_unit(const Motion& sequence, double said) {
  const auto known = known_topology(sequence.topology.num_vertices);
  return said > 0 ? said : known && known->mm_per_unit > 0 ? known->mm_per_unit : 1000;
}

// Characters are in metres, meshes of a folder in the unit of the sequences.
void scale_sequence(Motion& sequence, double metres_per_unit) {
  if (metres_per_unit == 1) return;
  for (float& v : sequence.values) v = static_cast<float>(metres_per_unit * v);
}

class Fitter {
 public:
  /// @param in_units_of_input  the faces are in the unit of the sequences, not in metres
  Fitter(const FitArguments& a, fs::path character_path, Character character,
         const std::optional<PersonFaces>& persons, bool in_units_of_input, ConsoleProgress& progress)
      : a_(a),
        character_path_(std::move(character_path)),
        character_(std::move(character)),
        persons_(persons),
        in_units_of_input_(in_units_of_input),
        progress_(progress) {}

  Status fit(const Task& task) {
    const auto outcome = a_.flame.empty() ? fit_shapes(task) : fit_flame_rig(task);
    if (!outcome) return within(outcome.error(), "'" + task.input.string() + "'");
    Bytes glb;
    if (task.output.extension() == ".glb") {
      MIEN_TRY(glb, write_glb(face(), {.normals = true, .pivot = neck_pivot(face()), .extras = {}}));
    }
    const Status written =
        write_motion(task.output, outcome->motion, {.character_glb = glb, .audio_name = "", .glb = {}});
    if (!written) return written.error();
    for (const auto& warning : written.warnings) progress_.warn(warning);
    progress_.finish_line();
    print_fit(task.input, task.output, *outcome, a_.json);
    if (residuals_.empty()) residuals_ = residual_header(*outcome);
    residuals_ += residual_rows(task.input.stem().string(), *outcome);
    num_frames_ += outcome->motion.num_frames();
    return Done{};
  }

  [[nodiscard]] const std::string& residuals() const { return residuals_; }
  [[nodiscard]] std::int64_t num_frames() const { return num_frames_; }

 private:
  [[nodiscard]] const Character& face() const { return flame_rig_ ? flame_rig_->character() : character_; }

  // Vertices of a face to coefficients of its shapes.
  Result<FitOutcome> fit_shapes(const Task& task) {
    auto sequence = read_sequence(task.input, a_.fps);
    if (!sequence) return sequence.error();
    for (const auto& warning : sequence.warnings) progress_.warn(warning);
    const double unit_mm = mm_per_unit(*sequence, a_.mm_per_unit);
    if (!rig_ || sequence->topology.num_vertices != rig_vertices_ || task.person != rig_person_) {
      if (persons_) character_ = persons_->face(task.person);
      MIEN_TRY(rig_, fit_rig(character_, a_.shapes, a_.vertices, sequence->topology.num_vertices));
      rig_vertices_ = sequence->topology.num_vertices;
      rig_person_ = task.person;
    }
    Motion part = taken_vertices(*rig_, std::move(*sequence));
    if (!in_units_of_input_) scale_sequence(part, unit_mm / 1000);
    const double to_fps = a_.to_fps.value_or(kCurvesFps);
    if (to_fps > 0 && part.fps != to_fps) part = resample(part, to_fps);
    const FitOptions options{.lower = 0, .upper = 1, .max_change = a_.max_change, .num_threads = a_.threads};
    auto fitted = fit_coefficients(rig_->neutral, rig_->shapes, part, rig_->regions, options, progress_);
    if (!fitted) return fitted.error();
    return FitOutcome{std::move(fitted->coefficients), std::move(fitted->residual),
                      std::move(fitted->region_residual), in_units_of_input_ ? unit_mm : 1000, unit_mm};
  }

  // Parameters of FLAME to coefficients, and all else to parameters of FLAME.
  Result<FitOutcome> fit_flame_rig(const Task& task) {
    std::error_code problem;
    auto motion = fs::is_directory(task.input, problem) ? read_sequence(task.input, a_.fps)
                                                        : read_motion(task.input, {.fps = a_.fps});
    if (!motion) return motion.error();
    for (const auto& warning : motion.warnings) progress_.warn(warning);
    const bool to_curves = motion->space == MotionSpace::flame;
    if (!to_curves && task.output.extension() == ".glb")
      return Error{Errc::usage, "output '" + task.output.string() + "'", "cannot hold FLAME parameters",
                   "Write .npy, .csv or .json"};
    const double unit_mm =
        motion->space == MotionSpace::vertices ? mm_per_unit(*motion, a_.mm_per_unit) : 1000;
    scale_sequence(*motion, unit_mm / 1000);
    if (!flame_rig_) {
      MIEN_TRY(FlameModel model, read_flame_model(a_.flame));
      MIEN_TRY(flame_rig_, FlameRig::create(std::move(model), std::move(character_), character_path_,
                                            {.shapes = a_.shapes,
                                             .vertices = a_.vertices,
                                             .max_change = a_.max_change,
                                             .expressions = a_.expressions,
                                             .threads = a_.threads}));
    }
    const double fps = a_.to_fps.value_or(to_curves ? kCurvesFps : kFlameFps);
    if (to_curves) {
      MIEN_TRY(FitResult fitted, flame_rig_->curves(*motion, fps, progress_));
      return FitOutcome{std::move(fitted.coefficients), std::move(fitted.residual),
                        std::move(fitted.region_residual), 1000, unit_mm};
    }
    MIEN_TRY(FlameFitResult fitted, flame_rig_->parameters(*motion, fps, progress_));
    return FitOutcome{std::move(fitted.parameters), std::move(fitted.residual),
                      std::move(fitted.region_residual), 1000, unit_mm};
  }

  const FitArguments& a_;
  fs::path character_path_;
  Character character_;
  const std::optional<PersonFaces>& persons_;
  bool in_units_of_input_;
  ConsoleProgress& progress_;
  std::optional<FitRig> rig_;
  std::optional<FlameRig> flame_rig_;
  std::int64_t rig_vertices_ = 0, num_frames_ = 0;
  std::string rig_person_;
  std::string residuals_;
};

Status check_arguments(const FitArguments& a) {
  if (!a.flame.empty() && !a.person_shapes.empty())
    return Error{Errc::usage, "--flame", "does not go with --person-shapes", "Leave one of them out"};
  if (a.flame.empty() && a.expressions > 0)
    return Error{Errc::usage, "--expressions", "are FLAME's", "Pass --flame too, or leave it out"};
  if (a.person_shapes.empty() != a.templates.empty())
    return Error{Errc::usage, "--person-shapes and --templates", "belong together",
                 "Pass both, or --character with one face"};
  if (a.person_shapes.empty()) return Done{};
  if (!a.character.empty())
    return Error{Errc::usage, "--character", "does not go with --person-shapes: persons have their own faces",
                 ""};
  if (a.format == ".glb" || a.output.ends_with(".glb"))
    return Error{Errc::usage, "output '" + a.output + "'",
                 "faces of --person-shapes have no triangles for a .glb", "Write .csv, .json or .npy"};
  return Done{};
}

Status run_fit(const FitArguments& a, ConsoleProgress& progress) {
  const auto start = std::chrono::steady_clock::now();
  MIEN_TRY([[maybe_unused]] const auto fits, check_arguments(a));
  MIEN_TRY(const auto sequences, find_sequences(a.input));
  fs::path path = a.person_shapes;
  std::optional<PersonFaces> persons;
  if (a.person_shapes.empty()) {
    MIEN_TRY(path, character_path(a.character));
  } else {
    MIEN_TRY(persons, PersonFaces::load(a.person_shapes, a.templates, a.vertices));
  }
  MIEN_TRY(auto tasks, plan_tasks(a, sequences, persons));
  const std::size_t num_found = tasks.size();
  std::error_code problem;
  if (a.output.ends_with('/')) {
    if (!a.force) std::erase_if(tasks, [](const Task& task) { return fs::exists(task.output); });
    for (const Task& task : tasks) {
      fs::create_directories(task.output.parent_path(), problem);
      if (problem)
        return Error{Errc::failed, "'" + task.output.parent_path().string() + "'",
                     "cannot be made: " + problem.message(), ""};
    }
  }
  constexpr OutputKind kKinds[] = {OutputKind::motion};
  for (const Task& task : tasks) {
    const std::string name = task.output.string();
    const std::array<fs::path, 4> inputs = {task.input, path, a.vertices, a.flame};
    MIEN_TRY(const auto outputs, plan_outputs({&name, 1}, inputs, kKinds));
    MIEN_TRY([[maybe_unused]] const auto writable, check_writable(outputs));
  }
  if (tasks.size() < num_found)
    progress.say(std::to_string(num_found - tasks.size()) + " of " + std::to_string(num_found) +
                 " outputs are there already; --force makes them again");
  progress.event("start", "\"command\":\"fit\",\"input\":" + json_string(a.input) + ",\"outputs\":[" +
                              json_string(a.output) + "]");
  Character character;
  if (!persons) {
    MIEN_TRY(character, load_character(path));
  }
  Fitter fitter(a, path, std::move(character), persons, persons || fs::is_directory(path, problem), progress);
  for (const Task& task : tasks) {
    if (progress.cancelled()) return Error{Errc::cancelled, "", "interrupted", ""};
    MIEN_TRY([[maybe_unused]] const auto done, fitter.fit(task));
  }
  if (std::fflush(stdout) != 0) return Error{Errc::failed, "standard output", "cannot be written", ""};
  if (!a.residuals.empty()) {
    MIEN_TRY([[maybe_unused]] const auto written,
             write_file(a.residuals, std::string_view(fitter.residuals())));
  }
  const double taken = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  progress.event("success", "\"outputs\":[" + json_string(a.output) +
                                "],\"sequences\":" + std::to_string(tasks.size()) + ",\"frames\":" +
                                std::to_string(fitter.num_frames()) + ",\"seconds\":" + fixed(taken, 3));
  progress.say("wrote " + a.output + ": " + std::to_string(tasks.size()) + " sequences, " +
               std::to_string(fitter.num_frames()) + " frames in " + fixed(taken, 2) + " s");
  return Done{};
}

}  // namespace

void add_fit_command(CLI::App& program, Chosen& chosen) {
  auto* command = program.add_subcommand("fit", "Find the coefficients of vertex sequences");
  auto a = std::make_shared<FitArguments>();
  command
      ->add_option(
          "INPUT", a->input,
          "A sequence: .npy, or a folder of .obj, .ply or .vl frames; or a folder of sequences. With "
          "--flame a motion file")
      ->required();
  command
      ->add_option(
          "-o,--output", a->output,
          "Coefficients (.csv .json .npy .glb), or a folder/ with a file per sequence; what is there "
          "already is not made again")
      ->required();
  command->add_option(
      "--character", a->character,
      "The sequence's face with shapes (.glb .gltf .vrm .safetensors), or a folder of neutral.obj "
      "and a mesh per shape. Default: Mien's head");
  command->add_option(
      "--flame", a->flame,
      "FLAME model (generic_model.pkl or .npz), whose topology --character has: INPUT of FLAME parameters "
      "becomes coefficients; INPUT of coefficients (.csv .json .npy .glb) or of vertices becomes FLAME's "
      "expression and jaw");
  command
      ->add_option("--expressions", a->expressions,
                   "How many of FLAME's expressions to use, 1 to 100. Default: ProbTalk3D's 50")
      ->check(CLI::Range(1, 100));
  command->add_option("--person-shapes", a->person_shapes,
                      "BlendVOCA's residuals (.pkl: person, shape, displacements) instead of --character; "
                      "sequences begin with their person's name");
  command->add_option("--templates", a->templates,
                      "The persons' neutral faces (VOCASET's templates.pkl, .safetensors, or a folder)");
  command->add_option(
      "--shapes", a->shapes,
      "Shapes to use: said (the 32 of BlendVOCA) or names apart by commas. Default: all; from FLAME "
      "all but the gaze and the tongue");
  command->add_option("--vertices", a->vertices,
                      "File of the vertices that count (BlendVOCA: FLAME_head_idx.txt). Default: all");
  command->add_option("--fps", a->fps, "Frames a second of INPUT, 1 to 240. Default: known from the data set")
      ->check(CLI::Range(1.0, 240.0));
  command
      ->add_option(
          "--to-fps", a->to_fps,
          "Frames a second of the output, 1 to 240; 0: those of INPUT. Default: 60 for coefficients, "
          "25 for FLAME")
      ->check(CLI::Range(0.0, 240.0));
  command
      ->add_option("--max-change", a->max_change,
                   "Most that a coefficient changes from frame to frame, 0.001 to 1")
      ->check(CLI::Range(0.001, 1.0))
      ->capture_default_str();
  command
      ->add_option("--mm-per-unit", a->mm_per_unit,
                   "Length of a unit of INPUT. Default: known from the data set, else 1000: metres")
      ->check(CLI::PositiveNumber);
  command->add_option("--format", a->format, "Files of an output folder: .csv, .json, .npy or .glb")
      ->check(CLI::IsMember({".csv", ".json", ".npy", ".glb"}))
      ->capture_default_str();
  command->add_option("--residuals", a->residuals, "Table of what is left over in every frame (.csv)");
  command->add_flag("--force", a->force, "Make outputs again that are there already");
  add_threads_option(*command, a->threads);
  command->add_flag("--quiet", chosen.quiet, "Print no progress");
  command->add_flag("--json", chosen.json,
                    "Print a JSON object per sequence, progress as JSON lines on stderr");
  add_footer(
      *command,
      "  mien fit take.npy --character face.glb -o take.csv --residuals left.csv\n"
      "  mien fit vertices_npy --character blendshapes/ --vertices FLAME_head_idx.txt --shapes said "
      "-o out/\n"
      "  mien fit vocaset/vertices_npy --person-shapes residuals.pkl --templates templates.pkl --vertices "
      "FLAME_head_idx.txt --shapes said --fps 60 -o coefficients/\n"
      "  mien fit hello.npy --flame generic_model.pkl --character flame_rig.glb -o hello.csv\n"
      "  mien fit hello.csv --flame generic_model.pkl --character flame_rig.glb -o hello.npy\n");
  command->callback([a, &chosen] {
    a->json = chosen.json;
    chosen.work = [a](ConsoleProgress& progress) { return run_fit(*a, progress); };
  });
}

}  // namespace mien
