// What a file forms/<kernel>.cpp needs: it defines <kernel>_forms(), the rows of its kernel. The build collects the
// files of this folder, so a kernel gets its shaders by such a file and the .comp files it names, and by nothing else.
#pragma once

#include "form_list.hpp"
#include "shader_table.hpp"
#include "shaders.hpp"
