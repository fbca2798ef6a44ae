#pragma once
#include <cstdint>
#include <string>

#include "mien/base/result.h"
#include "mien/core/motion.h"
#include "mien/io/text_sink.h"

namespace mien {

/// Time code of row n as FaceDiffuser's exporter for MetaHuman writes it: the clock advances by 1 / fps
/// seconds a row, rounded to microseconds each time, and the last field is sixty times the fraction of the
/// second (specification, section 9). Hours wrap after a day. @pre n >= 0, fps > 0
std::string metahuman_timecode(std::int64_t n, double fps);

/// Writes ARKit motion as that exporter does: Timecode, BlendShapeCount (51), and the 51 names of
/// ArkitOrder::beat with capital letters; channels that the motion lacks are 0. Programs that read by name
/// read it as Live Link Face CSV. Warnings: channels without a column. Errors: as write_live_link_csv().
Status write_metahuman_csv(const Motion& motion, const TextSink& sink);

}  // namespace mien
