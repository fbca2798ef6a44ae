#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "mien/base/bytes.h"
#include "mien/base/result.h"
#include "mien/core/character.h"
#include "mien/core/mesh.h"

namespace mien {

/// Wavefront OBJ: `v` and `f` lines; faces of more than three corners become fans, negative indices count
/// from the end. Vertices keep their number and order, whatever the faces use: sequences of positions depend
/// on it. Normals, texture coordinates, groups and materials are left out. Warnings: keywords that are not
/// known. Errors (Errc::input): numbers that are none or not finite, faces with fewer than three corners or
/// with vertices that do not exist, each with its line.
Result<Mesh> read_obj(std::string_view text);

/// The text of an OBJ file; numbers read back as the same floats. Without triangles: the vertices alone.
std::string write_obj(const Mesh& mesh);

/// PLY, ascii or binary little-endian: x, y, z of the vertices, faces as fans. Other elements and properties
/// are skipped. Errors: Errc::input for damaged files, Errc::incompatible for big-endian ones.
Result<Mesh> read_ply(std::span<const std::byte> bytes);

/// All parts of a character as one mesh, one after the other: positions, triangles, and colours if all parts
/// have them.
Mesh merged_mesh(const Character& character);

/// The shapes of merged_mesh(): shapes of one name become one, in the order in which they first appear.
std::vector<Blendshape> merged_shapes(const Character& character);

/// Positions and triangles of a mesh file, by extension: .obj, .ply, or the merged_mesh() of a character
/// (load_character). Errors: those of the readers, naming the file; Errc::usage for another extension.
Result<Mesh> load_mesh(const std::filesystem::path& path);

}  // namespace mien
