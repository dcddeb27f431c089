# Names of files and folders are text: neither make nor the shell reads one as code. A setting that
# holds a name is read by `name` where it stands between quotes for the shell, by `place` where it
# stands in rules too, and there by `target`; what would be more than a name is refused.
shell_signs := $$ '
make_signs := % : ; | * ? [ \ $(shell_signs)
name = $(call plain,$(1),$(shell_signs))
place = $(call plain,$(1),$(make_signs))
target = $(subst $() ,\ ,$(place))

plain = $(if $(given),$(if $(call odd,$(given),$(2)),$(error $(1) is no plain name: expected no blank, - or ~ in front, no tab or line break, and none of $(2)),$(given)),$(error $(1) is empty: expected $(1)=NAME))
odd = $(strip $(filter -% ~%,$(subst $() ,-,$(1))) $(foreach sign,$(2),$(findstring $(sign),$(1))) $(call blanks,$(subst $() ,,$(1))))
blanks = $(subst <$(strip $(1))>,,<$(1)>)

# What the command line or the environment says, not expanded; what a makefile says, expanded.
given = $(if $(filter command environment,$(origin $(1))),$(value $(1)),$($(1)))

# Options as one word for the shell.
quoted = '$(subst ','\'',$(1))'

# Make hands names to the shell unquoted in rules of its own, and expands what the command line says
# for the environment of every process.
MAKEFLAGS += -r
.SUFFIXES:
unexport $(foreach word,$(.VARIABLES),$(if $(filter command,$(origin $(word))),$(if $(findstring $$,$(value $(word))),$(word))))
