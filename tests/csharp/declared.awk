# Of forcebound.h a program in C that prints what it declares, as Declared.cs prints what Forcebound.cs does: constants,
# functions with the number of their parameters, each struct's size, and of each field offset, size and kind.
function trimmed(text) { gsub(/^[ \t]+|[ \t]+$/, "", text); return text }
function constant(name) { print "  CONSTANT(" name ");" }
BEGIN {
  print "#include <forcebound.h>"
  print "#include <stddef.h>"
  print "#include <stdio.h>"
  print "#define CONSTANT(name) printf(\"%s = %d\\n\", #name, (int)(name))"
  print "#define FUNCTION(name, parameters) ((void)name, printf(\"%s(%d)\\n\", #name, parameters))"
  print "#define STRUCT(type) printf(\"%s: %zu bytes\\n\", #type, sizeof(type))"
  # An array decays to a pointer to what it holds. A pointer to text is larger than no array of ours is small.
  print "#define KIND(field) _Generic((field), double: \"double\", double*: \"double\", int32_t: \"int\", \\"
  print "  uint32_t: \"uint\", int64_t: \"long\", uint64_t: \"ulong\", char*: \"text\", default: \"pointer\")"
  print "#define FIELD(type, field) \\"
  print "  printf(\"%s.%s: at %zu, %zu bytes, %s\\n\", #type, #field, offsetof(type, field), \\"
  print "         sizeof(((type*)0)->field), KIND(((type*)0)->field))"
  print "int main(void) {"
}
# Comments go first, those of many lines too.
{
  line = $0
  out = ""
  while (line != "") {
    if (inside) {
      end = index(line, "*/")
      if (!end) break
      line = substr(line, end + 2)
      inside = 0
    } else {
      begin = index(line, "/*")
      if (!begin) { out = out line; break }
      out = out substr(line, 1, begin - 1)
      line = substr(line, begin + 2)
      inside = 1
    }
  }
  $0 = out
}
/^#define FB_[A-Z_]+ +[0-9]+/ { constant($2); next }
/^#/ { next }
/^ *enum \{/ || /^enum/ { enumerating = 1 }
enumerating {
  text = $0
  while (match(text, /FB_[A-Z0-9_]+ *=/)) {
    name = substr(text, RSTART, RLENGTH)
    sub(/ *=/, "", name)
    constant(name)
    text = substr(text, RSTART + RLENGTH)
  }
  if (/\}/) enumerating = 0
  next
}
/^typedef struct fb_[a-z_]+ \{/ { type = $3; print "  STRUCT(" type ");"; next }
/^\}/ { type = ""; next }
type != "" && NF {
  field = field " " $0
  if (field !~ /;/) next
  name = field
  if (match(name, /\(\*[a-z_]+\)/)) {
    name = substr(name, RSTART + 2, RLENGTH - 3)
  } else {
    sub(/;.*/, "", name)
    sub(/\[.*/, "", name)
    sub(/^.*[ *]/, "", name)
  }
  print "  FIELD(" type ", " trimmed(name) ");"
  field = ""
  next
}
/^FB_EXPORT/ || prototype != "" {
  prototype = prototype " " $0
  if (prototype !~ /;/) next
  match(prototype, /fb_[a-z_]+\(/)
  name = substr(prototype, RSTART, RLENGTH - 1)
  parameters = substr(prototype, RSTART + RLENGTH)
  count = parameters ~ /^void\)/ ? 0 : gsub(/,/, ",", parameters) + 1
  print "  FUNCTION(" name ", " count ");"
  prototype = ""
}
END { print "  return 0;\n}" }
