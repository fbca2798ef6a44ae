#pragma once
#include <string_view>

#include "mien/base/error.h"
#include "mien/console/console_progress.h"

namespace mien {

/// 1 failed, 2 wrong usage, 3 input missing or unreadable, 4 things do not fit together, 130 interrupted.
int exit_code(Errc code);

/// Prints "error: what: why" and the fix on stderr, or the event, and returns the exit code. An error that is
/// not the end of the program has another event than "failure", and says with `fields` ("\"input\":...,")
/// whose it is.
int report_error(const Error& error, ConsoleProgress& progress, std::string_view event = "failure",
                 std::string_view fields = "");

/// From now on Ctrl-C cancels `progress`; a second one ends the program at once.
void cancel_on_interrupt(Progress& progress);

/// `text` as a JSON string with its quotes.
std::string json_string(std::string_view text);

}  // namespace mien
