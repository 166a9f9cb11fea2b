// What a file variants/<kernel>.cpp needs: it defines <kernel>_variants(), the rows of its kernel. The build collects
// the files of this folder, so a kernel gets its shaders by such a file and the .comp files it names, and by nothing
// else.
#pragma once

#include "engine/vulkan/dispatch/shader_table.hpp"
#include "shaders.hpp"
#include "variant_list.hpp"
