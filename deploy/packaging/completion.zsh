#compdef forcebound-client forcebound-server forcebound-relay forcebound-lab
# Completion of Forcebound's programs in zsh, read from each program's --help.

local program=$words[1] help
local -a commands options

if [[ $program == *forcebound-lab && $CURRENT -gt 2 && $words[2] == [a-z]* ]]; then
  help=$($program $words[2] --help 2>/dev/null)
else
  help=$($program --help 2>/dev/null)
fi

if [[ $program == *forcebound-lab && $CURRENT -eq 2 ]]; then
  commands=(${(f)"$(sed -n '/^Subcommands:/,/^$/s/^  \([a-z][a-z-]*\)  *\(.*\)$/\1:\2/p' <<<$help)"})
  _describe command commands
fi
options=(${(f)"$(sed -n 's/^  \(-[a-z],\)\{0,1\}\(--[a-z-]*\)[^ ]*  *\(.*\)$/\2:\3/p' <<<$help)"})
_describe -o option options || _files
