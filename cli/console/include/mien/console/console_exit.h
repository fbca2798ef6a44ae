#pragma once
#include "mien/base/error.h"
#include "mien/console/console_progress.h"

namespace mien {

/// 1 failed, 2 wrong usage, 3 input missing or unreadable, 4 things do not fit together, 130 interrupted.
int exit_code(Errc code);

/// Prints "error: what: why" and the fix on stderr (or a failure event) and returns the exit code.
int report_error(const Error& error, ConsoleProgress& progress);

/// From now on Ctrl-C cancels `progress`; a second one ends the program at once.
void cancel_on_interrupt(Progress& progress);

/// `text` as a JSON string with its quotes.
std::string json_string(std::string_view text);

}  // namespace mien
