#pragma once
#include <span>
#include <string>

#include "mien/base/result.h"
#include "mien/render/image.h"
#include "mien/render/motion_picture.h"

namespace mien {

/// Motions beside each other over time, as the figures of papers show emotions: a row for each, its name at
/// the left, and a column for each instant, its time above. On white; pictures lie 2 pixels apart, letters
/// are as high as the pictures allow.
///
/// @param rows    pictures of one size
/// @param labels  one for each row; names of more than the width of a picture are cut
/// @param times   seconds
/// Errors (Errc::usage): no instant, or a sheet of more than 16384 pixels on a side.
/// @pre at least one row, as many labels
Result<Image> motion_sheet(std::span<const MotionPicture> rows, std::span<const std::string> labels,
                           std::span<const double> times, int num_threads = 1);

}  // namespace mien
