# Completion of Forcebound's programs in bash. What there is to complete is read from the program's --help, so that it is
# always the program's own: commands, options, and the names that a section "Laws (--law):" lists for an option.

# Sets `help` to the text of --help of the command on the line: `forcebound COMMAND`, `forcebound lab COMMAND`,
# `forcebound-lab COMMAND`; and `depth` to how many words that is at most, the program's aside.
_forcebound_help() {
  local word
  local -a command=()
  depth=1
  if [[ ${words[1]} == lab ]]; then depth=2; fi
  for word in "${words[@]:1:cword-1}"; do
    [[ $word == [a-z]* ]] && ((${#command[@]} < depth)) || break
    command+=("$word")
  done
  help=$("$1" "${command[@]}" --help 2>/dev/null) || help=$("$1" --help 2>/dev/null)
}

_forcebound() {
  local cur prev words cword help depth type names
  _init_completion -n : || return
  _forcebound_help "$1"

  if [[ $prev == --* ]]; then
    # The option's type, as in "  --law LAW=fba-exact  text", or nothing of a flag.
    type=$(sed -n "s/^  \(-[a-z],\)\{0,1\}$prev \([^ ]*\).*/\2/p" <<<"$help")
    names=$(awk -v option="(${prev})" '
      /^[^ ]/ { inside = index($0, option) }
      inside && /^  [^ ]/ { sub(/:.*/, "", $1); print $1 }' <<<"$help")
    if [[ -n $names ]]; then
      mapfile -t COMPREPLY < <(compgen -W "$names" -- "$cur")
      # A name, or a file.
      if [[ $type =~ FILE\.([a-z]+) ]]; then _filedir "${BASH_REMATCH[1]}"; fi
      return
    fi
    case $type in
      "" | ...) ;;
      *FOLDER*) _filedir -d; return ;;
      *FILE*) _filedir; return ;;
      *[a-z]\|[a-z]*) mapfile -t COMPREPLY < <(compgen -W "$(tr '|' ' ' <<<"${type%=*}")" -- "$cur"); return ;;
      *) return ;;
    esac
  fi

  if [[ $cur == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(sed -n 's/^  \(-[a-z],\)\{0,1\}\(--[a-z-]*\).*/\2/p' <<<"$help")" -- "$cur")
  elif ((cword <= depth)) && [[ $help == *Subcommands:* ]]; then
    mapfile -t COMPREPLY < <(compgen -W \
      "$(sed -n '/^Subcommands:/,/^$/s/^  \([a-z][a-z-]*\)\( .*\)\{0,1\}$/\1/p' <<<"$help")" -- "$cur")
  else
    _filedir
  fi
}

complete -F _forcebound forcebound forcebound-client forcebound-server forcebound-relay forcebound-lab \
  forcebound-ros2
