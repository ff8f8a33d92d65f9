# bash completion for palpate. It queries the program for commands and flags, so they always match.

# First words of the indented lines of `palpate ... --help`: commands, or flags.
_palpate_commands() {
  "$1" --help 2>/dev/null | sed -n '/^Subcommands:/,$ s/^  \([a-z][a-z-]*\).*/\1/p'
}
_palpate_flags() {
  "$@" --help 2>/dev/null | sed -n 's/^ \{2,\}\(-[a-zA-Z],\)\{0,1\}\(--[a-zA-Z][a-zA-Z-]*\).*/\2/p'
}
# Commands below a command, such as those of study.
_palpate_below() {
  "$1" "$2" --help 2>/dev/null | sed -n '/^Subcommands:/,$ s/^  \([a-z][a-z-]*\).*/\1/p'
}

# Built-in names of a kind, such as organs. R of sphere:R is a number.
_palpate_names() {
  "$1" list "$2" 2>/dev/null | sed -n 's/^  \([^ ]*\).*/\1/p' | sed 's/:R$/:/'
}

_palpate() {
  local word="${COMP_WORDS[COMP_CWORD]}" before="${COMP_WORDS[COMP_CWORD - 1]}" program="${COMP_WORDS[0]}"
  COMPREPLY=()
  if [[ $COMP_CWORD -eq 1 ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_palpate_commands "$program") --help --version" -- "$word")
    return
  fi
  local command="${COMP_WORDS[1]}"
  case "$before" in
    --direction) mapfile -t COMPREPLY < <(compgen -W "press pull" -- "$word") ;;
    --organ | --tissue | --tool | --device | --inclusion | --task)
      local kind="${before#--}s"
      mapfile -t COMPREPLY < <(compgen -W "$(_palpate_names "$program" "$kind")" -- "$word")
      ;;
    --organ-motion) mapfile -t COMPREPLY < <(compgen -W "breathing heartbeat none" -- "$word") ;;
    --law) mapfile -t COMPREPLY < <(compgen -W "layered smooth" -- "$word") ;;
    --organ-frame) mapfile -t COMPREPLY < <(compgen -W "ras lps" -- "$word") ;;
    --unit | --organ-unit | --tool-unit) mapfile -t COMPREPLY < <(compgen -W "mm cm m in" -- "$word") ;;
    *)
      if [[ "$word" == -* ]]; then
        local below=()
        [[ $command == study && "${COMP_WORDS[2]}" == [a-z]* ]] && below=("${COMP_WORDS[2]}")
        mapfile -t COMPREPLY < <(compgen -W "$(_palpate_flags "$program" "$command" "${below[@]}")" -- "$word")
      elif [[ $COMP_CWORD -eq 2 ]]; then
        local words=""
        case "$command" in
          study) words="$(_palpate_below "$program" study)" ;;
          help) words="$(_palpate_commands "$program")" ;;
          list) words="organs tissues tools devices inclusions scenes tasks" ;;
        esac
        mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
      fi
      ;;
  esac
  # No completion of our own: -o default below completes a file.
}

complete -o default -F _palpate palpate
