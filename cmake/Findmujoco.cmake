# MuJoCo's C library as mujoco::mujoco. Its Python package (mujoco-core) keeps headers and library in one folder of
# TOPE_SITE_PACKAGES, the library under its full version; an unpacked release is found through CMAKE_PREFIX_PATH.
find_path(mujoco_INCLUDE_DIR mujoco/mujoco.h HINTS "${TOPE_SITE_PACKAGES}/mujoco/include")
file(GLOB mujoco_names RELATIVE "${TOPE_SITE_PACKAGES}/mujoco" "${TOPE_SITE_PACKAGES}/mujoco/libmujoco.so.*")
find_file(mujoco_LIBRARY NAMES ${mujoco_names} libmujoco.so HINTS "${TOPE_SITE_PACKAGES}/mujoco" PATH_SUFFIXES lib)
if(mujoco_INCLUDE_DIR)
  file(STRINGS "${mujoco_INCLUDE_DIR}/mujoco/mujoco.h" mujoco_number REGEX "define mjVERSION_HEADER +[0-9]+")
  string(REGEX MATCH "[0-9]+$" mujoco_number "${mujoco_number}")  # 4000001 is 4.0.1
  math(EXPR mujoco_major "${mujoco_number} / 1000000")
  math(EXPR mujoco_minor "${mujoco_number} / 1000 % 1000")
  math(EXPR mujoco_patch "${mujoco_number} % 1000")
  set(mujoco_VERSION "${mujoco_major}.${mujoco_minor}.${mujoco_patch}")
endif()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(mujoco REQUIRED_VARS mujoco_LIBRARY mujoco_INCLUDE_DIR VERSION_VAR mujoco_VERSION)
if(mujoco_FOUND AND NOT TARGET mujoco::mujoco)
  add_library(mujoco::mujoco SHARED IMPORTED)
  set_target_properties(mujoco::mujoco PROPERTIES
    IMPORTED_LOCATION "${mujoco_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${mujoco_INCLUDE_DIR}")
endif()
