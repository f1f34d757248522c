# What deploy/walk takes of a page: see there.
function emit(line, kind, text) { printf "%s:%d\t%s\t%s\n", page, line, kind, text }
function is_command(text) {
  sub(/^([A-Z_]+=[^ ]+ )+/, "", text)
  return text ~ /^(\.\/)?forcebound(-(server|client|relay|lab))?( |$)/ || text ~ /^deploy\/[a-z]/ ||
         text ~ /^(cmake|ctest|apt-get|man|systemctl|podman|kubectl|python3|cd|export) /
}
# Columns, before any comment.
function is_table(text) { sub(/ # .*/, "", text); return text ~ /[^ ]   +[^ ]/ }
/^<!-- .*made by/ { made = 1 }
/^<!-- \// { made = 0 }
made { next }
/^```/ { fenced = !fenced; next }
fenced { next }
file != "" {
  if (/^    /) { text = text substr($0, 5) "\\n"; next }
  if (/^ *$/) { text = text "\\n"; next }
  emit(begun, "file " file, text)
  file = ""
}
/^    # [a-z]+\.toml$/ { file = $2; text = ""; begun = FNR; next }
command != "" {
  sub(/^ +/, "")
  command = command " " $0
  if (!sub(/ *\\$/, "", command)) { emit(begun, "block", command); command = "" }
  next
}
/^    [^ ]/ {
  sub(/^ +/, "")
  if (!is_command($0) || is_table($0)) next
  command = $0
  begun = FNR
  if (!sub(/ *\\$/, "", command)) { emit(begun, "block", command); command = "" }
  next
}
{
  count = split($0, spans, "`")
  for (i = 2; i < count; i += 2) {
    if (spans[i] ~ /^deploy\/[a-z]/) emit(FNR, "text", spans[i])
    else if (spans[i] ~ /^(\.\/)?forcebound(-(server|client|relay|lab))? /) emit(FNR, "name", spans[i])
  }
}
END { if (file != "") emit(begun, "file " file, text) }
