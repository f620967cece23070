// The stagewise solver once more, compiled for processors with AVX2 and fused multiply-add (see CMakeLists.txt). Its
// namespace has another name, so that the linker keeps the two apart; module.cpp chooses when the module is loaded.
#define stagewise stagewise_v3
#define TIGHTSPOT_BIND_STAGEWISE bind_stagewise_v3
#include "stagewise.cpp"
