# bash completion for palpate. Commands and flags are asked of the program itself, so they are always its own.

# The words of `palpate ... --help` that stand first on an indented line: commands, or flags.
_palpate_commands() {
  "$1" --help 2>/dev/null | sed -n '/^Subcommands:/,$ s/^  \([a-z][a-z-]*\).*/\1/p'
}
_palpate_flags() {
  "$1" "$2" --help 2>/dev/null | sed -n 's/^  \(-[a-zA-Z],\)\{0,1\}\(--[a-zA-Z][a-zA-Z-]*\).*/\2/p'
}

# What it says of a name it does not know: built-in organs.
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
    --unit | --organ-unit | --tool-unit) mapfile -t COMPREPLY < <(compgen -W "mm cm m in" -- "$word") ;;
    *)
      if [[ "$word" == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(_palpate_flags "$program" "${COMP_WORDS[1]}")" -- "$word")
      fi
      ;;
  esac
  # Nothing of ours: a file, which is what -o default says below.
}

complete -o default -F _palpate palpate
