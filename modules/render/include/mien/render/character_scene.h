#pragma once
#include "mien/core/character.h"
#include "mien/face/pose.h"
#include "mien/render/scene.h"

namespace mien {

/// The surfaces of a posed character, ready to draw. Eyes and teeth shine and hair does a little, as the
/// names of the parts tell ("eyeLeft", "Teeth_upper", "hair"); everything else is skin. Both arguments must
/// outlive the scene.
/// @pre one posed part per part of the character
Scene character_scene(const Character& character, const PosedCharacter& posed);

}  // namespace mien
