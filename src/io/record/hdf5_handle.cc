#include "io/record/hdf5_handle.h"

#include <algorithm>

#include "core/base/content_hash.h"

namespace palpate::record::hdf5 {
namespace {

herr_t follow_no_link(const char* /*file*/, const char* /*group*/, const char* /*other_file*/,
                      const char* /*object*/, unsigned* /*flags*/, hid_t /*access*/, void* /*data*/) {
  return -1;
}

/// Access properties that follow no link to another file. @param kind H5P_DATASET_ACCESS or H5P_GROUP_ACCESS
Handle within_the_file(hid_t kind) {
  Handle access(H5Pcreate(kind), "access properties");
  check(H5Pset_elink_cb(access.id(), follow_no_link, nullptr), "access properties");
  return access;
}

constexpr const char* kContentHash = "content_hash";
constexpr std::size_t kLongestAttribute = 32768;  // bytes; HDF5 allows less than 64 KB

void write_value(hid_t object, const std::string& name, hid_t type, const void* value) {
  const Handle space(H5Screate(H5S_SCALAR), "space of " + name);
  const Handle attribute(H5Acreate2(object, name.c_str(), type, space.id(), H5P_DEFAULT, H5P_DEFAULT), name);
  check(H5Awrite(attribute.id(), type, value), name);
}

Handle open_attribute(hid_t object, const std::string& name) {
  Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), "no attribute " + name);
  const Handle space(H5Aget_space(attribute.id()), name);
  if (H5Sget_simple_extent_npoints(space.id()) != 1) throw Error("attribute " + name + " is not one value");
  return attribute;
}

std::size_t fixed_text_bytes(hid_t type, const std::string& name, std::size_t longest) {
  const std::size_t bytes = H5Tget_size(type);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0) {
    throw Error(name + " is not a text of fixed length");
  }
  if (bytes == 0 || bytes > longest) throw Error(name + " is too long");
  return bytes;
}

std::string without_padding(std::string text) {
  const std::size_t end = text.find('\0');
  if (end != std::string::npos) text.resize(end);
  return text;
}

}  // namespace

SilenceErrors::SilenceErrors() {
  H5dont_atexit();
  H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

SilenceErrors::~SilenceErrors() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

Handle::Handle(hid_t id, const std::string& what) : id_(id) { check(id < 0 ? -1 : 0, what); }

bool Handle::close() noexcept {
  if (!valid()) return true;
  const hid_t id = std::exchange(id_, H5I_INVALID_HID);
  return H5Iget_type(id) == H5I_FILE ? H5Fclose(id) >= 0 : H5Idec_ref(id) >= 0;
}

void check(herr_t status, const std::string& what) {
  if (status < 0) throw Error(what);
}

Handle text_type(std::size_t bytes) {
  Handle type(H5Tcopy(H5T_C_S1), "text type");
  check(H5Tset_size(type.id(), std::max<std::size_t>(bytes, 1)), "text length");
  check(H5Tset_cset(type.id(), H5T_CSET_UTF8), "text type");
  check(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), "text type");
  return type;
}

Handle create_group(hid_t parent, const std::string& name) {
  return Handle(H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), name);
}

void write_attribute(hid_t object, const std::string& name, const std::string& value) {
  std::string text = value.substr(0, kLongestAttribute);
  text.resize(std::max<std::size_t>(text.size(), 1));
  write_value(object, name, text_type(text.size()).id(), text.data());
}

void write_attribute(hid_t object, const std::string& name, double value) {
  write_value(object, name, H5T_NATIVE_DOUBLE, &value);
}

void write_attribute(hid_t object, const std::string& name, std::int64_t value) {
  write_value(object, name, H5T_NATIVE_INT64, &value);
}

void write_attribute(hid_t object, const std::string& name, std::uint64_t value) {
  write_value(object, name, H5T_NATIVE_UINT64, &value);
}

void rewrite_attribute(hid_t object, const std::string& name, std::int64_t value) {
  const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), name);
  check(H5Awrite(attribute.id(), H5T_NATIVE_INT64, &value), name);
}

std::string read_text_attribute(hid_t object, const std::string& name) {
  const Handle attribute = open_attribute(object, name);
  const Handle type(H5Aget_type(attribute.id()), name);
  std::string text(fixed_text_bytes(type.id(), "attribute " + name, kLongestAttribute), '\0');
  check(H5Aread(attribute.id(), type.id(), text.data()), "attribute " + name + " cannot be read");
  return without_padding(std::move(text));
}

std::int64_t read_integer_attribute(hid_t object, const std::string& name) {
  const Handle attribute = open_attribute(object, name);
  std::int64_t value = 0;
  check(H5Aread(attribute.id(), H5T_NATIVE_INT64, &value), "attribute " + name + " is not a number");
  return value;
}

Handle create_dataset(hid_t parent, const std::string& name, hid_t type,
                      const std::vector<hsize_t>& dimensions) {
  const Handle space(dimensions.empty()
                         ? H5Screate(H5S_SCALAR)
                         : H5Screate_simple(static_cast<int>(dimensions.size()), dimensions.data(), nullptr),
                     "space of " + name);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), name);
  check(H5Pset_alloc_time(properties.id(), H5D_ALLOC_TIME_EARLY), name);
  return Handle(H5Dcreate2(parent, name.c_str(), type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
                name);
}

hid_t open_dataset(hid_t parent, const std::string& name) {
  const hid_t id = H5Dopen2(parent, name.c_str(), within_the_file(H5P_DATASET_ACCESS).id());
  if (id < 0) return id;
  Handle dataset(id, name);
  const Handle made(H5Dget_create_plist(id), name);
  if (H5Pget_external_count(made.id()) != 0 || H5Pget_layout(made.id()) == H5D_VIRTUAL) {
    throw Error(name + " is kept in another file, must be in the recording itself");
  }
  dataset.abandon();
  return id;
}

hid_t open_group(hid_t parent, const std::string& name) {
  return H5Gopen2(parent, name.c_str(), within_the_file(H5P_GROUP_ACCESS).id());
}

bool has_link(hid_t parent, const std::string& group, const std::string& name) {
  const hid_t id = open_group(parent, group);
  if (id < 0) return false;
  const Handle opened(id, group);
  return H5Lexists(opened.id(), name.c_str(), H5P_DEFAULT) > 0;
}

Handle create_text(hid_t parent, const std::string& name, std::size_t bytes) {
  return create_dataset(parent, name, text_type(bytes).id(), {});
}

void write_text(hid_t dataset, const std::string& text) {
  const Handle type(H5Dget_type(dataset), "text type");
  std::string padded = text;
  padded.resize(H5Tget_size(type.id()));
  check(H5Dwrite(dataset, type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()), "text");
}

std::string read_text(hid_t parent, const std::string& name, std::size_t longest) {
  const Handle dataset(open_dataset(parent, name), "no /" + name);
  const Handle space(H5Dget_space(dataset.id()), name);
  if (H5Sget_simple_extent_npoints(space.id()) != 1) throw Error("/" + name + " is not one text");
  const Handle type(H5Dget_type(dataset.id()), name);
  std::string text(fixed_text_bytes(type.id(), "/" + name, longest), '\0');
  check(H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()),
        "/" + name + " cannot be read");
  check_content_hash(dataset.id(), "/" + name, std::as_bytes(std::span(text)));
  return without_padding(std::move(text));
}

Handle create_growing_pairs(hid_t parent, const std::string& name) {
  constexpr hsize_t kNone[2] = {0, 2};
  constexpr hsize_t kMax[2] = {H5S_UNLIMITED, 2};
  constexpr hsize_t kChunk[2] = {512, 2};
  constexpr unsigned kLevel = 4;
  const Handle space(H5Screate_simple(2, kNone, kMax), "space of " + name);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), name);
  check(H5Pset_chunk(properties.id(), 2, kChunk), "chunks of " + name);
  check(H5Pset_deflate(properties.id(), kLevel), "compression of " + name);
  return Handle(H5Dcreate2(parent, name.c_str(), H5T_NATIVE_INT64, space.id(), H5P_DEFAULT, properties.id(),
                           H5P_DEFAULT),
                name);
}

void fill_pairs(hid_t dataset, const std::string& name, const std::vector<std::int64_t>& values) {
  if (values.empty()) return;
  const hsize_t shape[2] = {values.size() / 2, 2};
  check(H5Dset_extent(dataset, shape), name + " cannot be written");
  check(H5Dwrite(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
        name + " cannot be written");
}

std::vector<std::int64_t> read_pairs(hid_t parent, const std::string& name, std::size_t longest) {
  const Handle dataset(open_dataset(parent, name), "no " + name);
  const Handle space(H5Dget_space(dataset.id()), name);
  hsize_t shape[2] = {0, 0};
  if (H5Sget_simple_extent_ndims(space.id()) != 2 ||
      H5Sget_simple_extent_dims(space.id(), shape, nullptr) < 0 || shape[1] != 2) {
    throw Error(name + " is not N x 2");
  }
  if (shape[0] > longest) throw Error(name + " is too long");
  std::vector<std::int64_t> values(2 * shape[0]);
  if (values.empty()) return values;
  check(H5Dread(dataset.id(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
        name + " cannot be read");
  return values;
}

bool has_attribute(hid_t object, const std::string& name) {
  const htri_t found = H5Aexists(object, name.c_str());
  check(found < 0 ? -1 : 0, "attribute " + name + " cannot be looked for");
  return found > 0;
}

bool has_link(hid_t parent, const std::string& name) {
  const htri_t found = H5Lexists(parent, name.c_str(), H5P_DEFAULT);
  check(found < 0 ? -1 : 0, name + " cannot be looked for");
  return found > 0;
}

void write_content_hash(hid_t dataset, std::span<const std::byte> values) {
  write_attribute(dataset, kContentHash, ContentHasher().add(values).hash().hexadecimal());
}

void check_content_hash(hid_t dataset, const std::string& name, std::span<const std::byte> values) {
  if (!has_attribute(dataset, kContentHash)) return;
  if (read_text_attribute(dataset, kContentHash) == ContentHasher().add(values).hash().hexadecimal()) return;
  throw Error(name + " is damaged: its values are others than those that were recorded");
}

std::size_t rows_of_three(hid_t dataset, const std::string& name, std::size_t value_bytes,
                          std::uint64_t file_bytes) {
  constexpr std::uint64_t kBestCompression = 1100;  // largest ratio of deflate; other tools may use it
  const Handle space(H5Dget_space(dataset), name);
  hsize_t dimensions[2] = {0, 0};
  if (H5Sget_simple_extent_ndims(space.id()) != 2 ||
      H5Sget_simple_extent_dims(space.id(), dimensions, nullptr) < 0 || dimensions[1] != 3) {
    throw Error(name + " is not N x 3");
  }
  if (dimensions[0] > file_bytes * kBestCompression / (3 * value_bytes)) {
    throw Error(name + " claims more rows than the file can hold");
  }
  return dimensions[0];
}

}  // namespace palpate::record::hdf5
