#include "mien/render/motion_picture.h"

#include <algorithm>
#include <cmath>

#include "mien/core/arkit.h"
#include "mien/face/vertex_sequence.h"
#include "mien/render/character_scene.h"
#include "mien/render/text.h"

namespace mien {
namespace {

constexpr int kMaxPictureSide = 8192;

// Values at an instant, as resample() would give them.
std::vector<float> values_at(const Motion& motion, double seconds) {
  std::vector<float> values(static_cast<std::size_t>(motion.num_channels()), 0.0f);
  const std::int64_t count = motion.num_frames();
  if (count == 0) return values;
  const double position = std::clamp(seconds * motion.fps, 0.0, static_cast<double>(count - 1));
  const auto left = static_cast<std::int64_t>(position), right = std::min(left + 1, count - 1);
  const auto share = static_cast<float>(position - static_cast<double>(left));
  const auto a = motion.frame(left), b = motion.frame(right);
  for (std::size_t c = 0; c < values.size(); ++c) values[c] = a[c] + share * (b[c] - a[c]);
  return values;
}

void hold_head(const std::vector<std::string>& channels, std::vector<float>& values) {
  for (std::size_t c = 0; c < channels.size(); ++c)
    if (std::find(head_names().begin(), head_names().end(), channels[c]) != head_names().end()) values[c] = 0;
}

std::int64_t num_vertices(const Character& character) {
  std::int64_t count = 0;
  for (const CharacterPart& part : character.parts)
    count += static_cast<std::int64_t>(part.mesh.positions.size());
  return count;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

Result<MotionPicture> MotionPicture::create(const Character& character, std::vector<const Motion*> motions,
                                            const MotionPictureOptions& options) {
  MIEN_TRY([[maybe_unused]] const auto valid, options.shading.validate());
  contract(!motions.empty(), "MotionPicture: at least one motion expected");
  contract(options.labels.empty() || options.labels.size() == motions.size(),
           "MotionPicture: one label for each motion expected");
  contract(options.columns >= 0, "MotionPicture: columns may not be negative");
  const auto count = static_cast<std::int64_t>(motions.size());
  const auto columns = options.columns > 0 ? std::min<std::int64_t>(options.columns, count) : count;
  const std::int64_t rows = (count + columns - 1) / columns;
  if (options.shading.width * columns > kMaxPictureSide || options.strip_height < 0 ||
      (options.shading.height + std::int64_t{options.strip_height}) * rows > kMaxPictureSide)
    return Error{Errc::usage, "picture",
                 "would be larger than " + std::to_string(kMaxPictureSide) + " pixels on a side",
                 "Choose a smaller size or fewer motions"};
  if (character.parts.empty())
    return Error{Errc::incompatible, "character '" + character.name + "'", "has nothing to draw", ""};

  const double aspect = static_cast<double>(options.shading.width) / options.shading.height;
  MotionPicture picture(character, options, frame_character(character, options.view, aspect));
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const Motion& motion = *motions[i];
    const std::string name = options.labels.empty() ? "motion" : "motion '" + options.labels[i] + "'";
    if (motion.space == MotionSpace::vertices) {
      if (motion.topology.num_vertices != num_vertices(character))
        return Error{Errc::incompatible, name,
                     "moves " + std::to_string(motion.topology.num_vertices) +
                         " vertices, the character has " + std::to_string(num_vertices(character)),
                     "Use the mesh that the motion was made for"};
      if (motion.num_frames() == 0) return Error{Errc::input, name, "has no frames", ""};
      picture.performers_.push_back(
          {&motion, options.labels.empty() ? "" : options.labels[i], Poser(character, {})});
      continue;
    }
    if (motion.space != MotionSpace::arkit && motion.space != MotionSpace::rig)
      return Error{Errc::incompatible, name, "has no named coefficients that could move a character",
                   "Convert it to ARKit coefficients first"};
    Performer performer{&motion, options.labels.empty() ? "" : options.labels[i],
                        Poser(character, motion.channels)};
    const auto& unused = performer.poser.unused_channels();
    if (!motion.channels.empty() && unused.size() == motion.channels.size())
      return Error{Errc::incompatible, name,
                   "none of its channels (" + joined(unused).substr(0, 200) + ") is a shape of the character",
                   ""};
    if (!unused.empty()) warnings.push_back(name + ": the character lacks " + joined(unused));
    picture.performers_.push_back(std::move(performer));
  }
  Result<MotionPicture> result(std::move(picture));
  result.warnings = std::move(warnings);
  return result;
}

int MotionPicture::num_columns() const {
  const int count = static_cast<int>(performers_.size());
  return options_.columns > 0 ? std::min(options_.columns, count) : count;
}
int MotionPicture::num_rows() const {
  return (static_cast<int>(performers_.size()) + num_columns() - 1) / num_columns();
}
int MotionPicture::width() const { return options_.shading.width * num_columns(); }
int MotionPicture::height() const { return (options_.shading.height + options_.strip_height) * num_rows(); }

double MotionPicture::seconds() const {
  double longest = 0;
  for (const Performer& p : performers_) longest = std::max(longest, p.motion->seconds());
  return longest;
}

MotionPicture::Scratch MotionPicture::take_scratch() const {
  const std::lock_guard lock(pool_->mutex);
  if (pool_->idle.empty()) return {};
  Scratch scratch = std::move(pool_->idle.back());
  pool_->idle.pop_back();
  return scratch;
}

Image MotionPicture::at(double seconds, int num_threads) const {
  if (!std::isfinite(seconds)) seconds = 0;
  Scratch scratch = take_scratch();
  Image picture(width(), height(), options_.shading.background_border);  // seen where no face is
  RenderOptions shading = options_.shading;
  shading.num_threads = num_threads;
  int place = 0;
  for (const Performer& p : performers_) {
    const int x = place % num_columns() * shading.width;
    const int y = place / num_columns() * (shading.height + options_.strip_height);
    ++place;
    std::vector<float> values = values_at(*p.motion, seconds);
    if (options_.view == CameraView::mouth) hold_head(p.motion->channels, values);
    if (p.motion->space == MotionSpace::vertices)
      pose_vertices(*character_, values, scratch.posed);
    else
      p.poser.pose(values, scratch.posed);
    const Scene scene = character_scene(*character_, scratch.posed);
    blit(picture, render(scene, camera_, shading, &scratch.render).value(), x, y);
    if (!p.label.empty()) draw_text(picture, x + 6, y + 4, fit_text(p.label, shading.width - 12));
    if (options_.strip_height > 0) {
      CurveStripOptions strip = options_.strip;
      strip.start_seconds = seconds - 0.5 * strip.seconds;
      strip.playhead_seconds = seconds;
      blit(picture, curve_strip(shading.width, options_.strip_height, *p.motion, options_.log_mel, strip), x,
           y + shading.height);
    }
  }
  const std::lock_guard lock(pool_->mutex);
  pool_->idle.push_back(std::move(scratch));
  return picture;
}

}  // namespace mien
