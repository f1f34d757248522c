#compdef forcebound forcebound-client forcebound-server forcebound-relay forcebound-lab forcebound-ros2
# Completion of Forcebound's programs in zsh, read from each program's --help.

# The command on the line: `forcebound COMMAND`, `forcebound lab COMMAND`, `forcebound-lab COMMAND`.
local program=$words[1] help word depth=1
local -a command commands options
if [[ $words[2] == lab ]]; then depth=2; fi
for word in ${words[2,CURRENT-1]}; do
  if [[ $word != [a-z]* || $#command -ge $depth ]]; then break; fi
  command+=($word)
done
help=$($program $command --help 2>/dev/null) || help=$($program --help 2>/dev/null)

if [[ $help == *Subcommands:* && $CURRENT -le $((depth + 1)) ]]; then
  commands=(${(f)"$(sed -n '/^Subcommands:/,/^$/s/^  \([a-z][a-z-]*\)  *\(.*\)$/\1:\2/p' <<<$help)"})
  _describe command commands
fi
options=(${(f)"$(sed -n 's/^  \(-[a-z],\)\{0,1\}\(--[a-z-]*\)[^ ]*  *\(.*\)$/\2:\3/p' <<<$help)"})
_describe -o option options || _files
