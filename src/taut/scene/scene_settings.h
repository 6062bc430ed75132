#pragma once
// Changes to a scene from the command line, applied to the TOML document before it is read, so that
// they are checked like the file.

#include <toml++/toml.h>

#include <string>

namespace taut {

// "key=value", see read_scene. Throws InputError("--set key=value: ...") when the text has no such
// form or the path leads nowhere.
void apply_setting(toml::table& document, const std::string& setting);

}  // namespace taut
