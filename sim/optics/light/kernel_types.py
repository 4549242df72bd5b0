"""Names of the device arrays that the optics' kernels take."""

import taichi as ti
import taichi.math as tm

Bytes = ti.types.ndarray(dtype=ti.u8, ndim=1)
Integers = ti.types.ndarray(dtype=ti.i32, ndim=1)
IntegerRows = ti.types.ndarray(dtype=ti.i32, ndim=2)
Longs = ti.types.ndarray(dtype=ti.i64, ndim=1)
Floats = ti.types.ndarray(dtype=ti.f32, ndim=1)
FloatRows = ti.types.ndarray(dtype=ti.f32, ndim=2)
Pairs = ti.types.ndarray(dtype=tm.vec2, ndim=1)
Vectors = ti.types.ndarray(dtype=tm.vec3, ndim=1)
VectorRows = ti.types.ndarray(dtype=tm.vec3, ndim=2)
FourRows = ti.types.ndarray(dtype=tm.vec4, ndim=2)
FloatTables = ti.types.ndarray(dtype=ti.f32, ndim=3)
NormalTables = ti.types.ndarray(dtype=ti.f32, ndim=5)
