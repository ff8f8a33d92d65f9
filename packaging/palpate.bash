# bash completion for palpate. It queries the program for commands and flags, so they always match.

# First words of the indented lines of `palpate ... --help`: commands, or flags.
_palpate_commands() {
  "$1" --help 2>/dev/null | sed -n '/^Subcommands:/,$ s/^  \([a-z][a-z-]*\).*/\1/p'
}
_palpate_flags() {
  "$1" "$2" --help 2>/dev/null | sed -n 's/^  \(-[a-zA-Z],\)\{0,1\}\(--[a-zA-Z][a-zA-Z-]*\).*/\2/p'
}

# Names of built-in organs, from the error message for an unknown name.
_palpate_organs() {
  "$1" inspect ? 2>&1 | sed -n 's/.*(built in: \([^;]*\);.*/\1/p' | tr -d ','
}

_palpate() {
  local word="${COMP_WORDS[COMP_CWORD]}" before="${COMP_WORDS[COMP_CWORD - 1]}" program="${COMP_WORDS[0]}"
  COMPREPLY=()
  if [[ $COMP_CWORD -eq 1 ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(_palpate_commands "$program") --help --version" -- "$word")
    return
  fi
  case "$before" in
    --task | --direction) mapfile -t COMPREPLY < <(compgen -W "press pull" -- "$word") ;;
    --organ) mapfile -t COMPREPLY < <(compgen -W "$(_palpate_organs "$program")" -- "$word") ;;
    --law) mapfile -t COMPREPLY < <(compgen -W "layered smooth" -- "$word") ;;
    --organ-frame) mapfile -t COMPREPLY < <(compgen -W "ras lps" -- "$word") ;;
    --unit | --organ-unit | --tool-unit) mapfile -t COMPREPLY < <(compgen -W "mm cm m in" -- "$word") ;;
    *)
      if [[ "$word" == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(_palpate_flags "$program" "${COMP_WORDS[1]}")" -- "$word")
      fi
      ;;
  esac
  # No completion of our own: -o default below completes a file.
}

complete -o default -F _palpate palpate
