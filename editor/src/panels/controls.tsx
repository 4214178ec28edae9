/** The few kinds of controls that the panels are made of. */

import type { ComponentChildren } from "preact";
import { useEffect, useId, useRef, useState } from "preact/hooks";
import { Icon, type IconName } from "./icons.tsx";

interface ButtonProps {
  icon?: IconName;
  label: string;
  /** The key that does the same. */
  hint?: string;
  /** Only the icon is shown. */
  quiet?: boolean;
  pressed?: boolean;
  disabled?: boolean;
  primary?: boolean;
  onClick: () => void;
}

export function Button({ icon, label, hint, quiet, pressed, disabled, primary, onClick }: ButtonProps) {
  return (
    <button
      type="button"
      class={`button ${quiet ? "quiet" : ""} ${primary ? "primary" : ""}`}
      title={hint ? `${label} (${hint})` : label}
      aria-label={label}
      {...(pressed !== undefined && { "aria-pressed": pressed })}
      disabled={disabled ?? false}
      onClick={onClick}
    >
      {icon && <Icon name={icon} />}
      {!quiet && <span>{label}</span>}
    </button>
  );
}

interface SegmentedProps<T extends string> {
  label: string;
  value: T;
  options: readonly { value: T; label: string; title?: string }[];
  onChange: (value: T) => void;
}

/** One of a few. Real radio buttons, so that the keyboard and screen readers know them. */
export function Segmented<T extends string>({ label, value, options, onChange }: SegmentedProps<T>) {
  const name = useId();
  return (
    <fieldset class="segmented">
      <legend class="visually-hidden">{label}</legend>
      {options.map((option) => (
        <label key={option.value} title={option.title} class={option.value === value ? "chosen" : ""}>
          <input
            type="radio"
            name={name}
            checked={option.value === value}
            onChange={() => onChange(option.value)}
          />
          <span>{option.label}</span>
        </label>
      ))}
    </fieldset>
  );
}

interface SliderProps {
  label: string;
  title?: string;
  value: number;
  min: number;
  max: number;
  /** Equal ways are equal factors. `min` > 0. */
  logarithmic?: boolean;
  /** Nothing beyond `max` can be typed either. */
  closed?: boolean;
  onInput: (value: number) => void;
  onDone: () => void;
}

const STEPS = 400;

export function Slider({ label, title, value, min, max, logarithmic, closed, onInput, onDone }: SliderProps) {
  const id = useId();
  const toPlace = (v: number): number =>
    STEPS * (logarithmic ? Math.log(v / min) / Math.log(max / min) : (v - min) / (max - min));
  const fromPlace = (at: number): number =>
    logarithmic ? min * (max / min) ** (at / STEPS) : min + ((max - min) * at) / STEPS;
  return (
    <div class="slider" title={title}>
      <label for={id}>{label}</label>
      <input
        id={id}
        type="range"
        min="0"
        max={STEPS}
        value={Math.min(STEPS, Math.max(0, toPlace(value)))}
        aria-valuetext={short(value)}
        onInput={(event) => onInput(round(fromPlace(Number(event.currentTarget.value))))}
        onChange={onDone}
      />
      <NumberField label={label} value={value} min={logarithmic ? Number.MIN_VALUE : min} max={closed ? max : Infinity} onChange={(v) => { onInput(v); onDone(); }} />
    </div>
  );
}

const round = (value: number): number => Number(value.toPrecision(3));

interface SwitchProps {
  label: string;
  title?: string;
  on: boolean;
  onChange: (on: boolean) => void;
}

/** On or off, at once. */
export function Switch({ label, title, on, onChange }: SwitchProps) {
  return (
    <label class="switch" title={title}>
      <span>{label}</span>
      <input type="checkbox" role="switch" checked={on} onChange={(event) => onChange(event.currentTarget.checked)} />
    </label>
  );
}

interface NumberFieldProps {
  label: string;
  value: number;
  min?: number;
  max?: number;
  whole?: boolean;
  disabled?: boolean;
  prefix?: string;
  /** How it is shown; six digits by default. */
  shown?: string;
  onChange: (value: number) => void;
}

/** A number to be typed; taken with Enter or when the field is left. What is no number is forgotten. */
export function NumberField({ label, value, min, max, whole, disabled, prefix, shown, onChange }: NumberFieldProps) {
  const [text, setText] = useState<string | null>(null);
  const take = (): void => {
    const number = text === null || text.trim() === "" ? Number.NaN : Number(text.replace(",", "."));
    setText(null);
    const fits =
      Number.isFinite(number) && number >= (min ?? -Infinity) && number <= (max ?? Infinity) && (!whole || Number.isInteger(number));
    if (fits && number !== value) onChange(number);
  };
  return (
    <span class="number">
      {prefix && <span aria-hidden="true">{prefix}</span>}
      <input
        type="text"
        inputMode="decimal"
        aria-label={label}
        disabled={disabled ?? false}
        value={text ?? shown ?? short(value)}
        onFocus={(event) => event.currentTarget.select()}
        onInput={(event) => setText(event.currentTarget.value)}
        onBlur={take}
        onKeyDown={(event) => {
          if (event.key === "Enter") take();
          if (event.key === "Escape") {
            event.stopPropagation();
            setText(null);
          }
        }}
      />
    </span>
  );
}

/** A number as one reads it: six digits are enough. */
export const short = (value: number): string => String(Number(value.toPrecision(6)));

/** Whether nobody can see a distance on a shape of that size. */
export const arrived = (away: number, size: number): boolean => away < 1e-7 * size;

/** A distance with two digits; what cannot be seen on a shape of that size is none. */
export const distance = (away: number, size: number): string => (arrived(away, size) ? "0" : short(Number(away.toPrecision(2))));

interface MenuProps {
  label: string;
  icon?: IconName;
  primary?: boolean;
  disabled?: boolean;
  children: (close: () => void) => ComponentChildren;
}

/** A button that opens a list; closed by Escape, by a click elsewhere, and by a choice. */
export function Menu({ label, icon, primary, disabled, children }: MenuProps) {
  const [open, setOpen] = useState(false);
  const root = useRef<HTMLDivElement>(null);
  useEffect(() => {
    if (!open) return undefined;
    root.current?.querySelector<HTMLElement>("[role=menuitem]")?.focus();
    const away = (event: Event): void => {
      if (!root.current?.contains(event.target as Node)) setOpen(false);
    };
    document.addEventListener("pointerdown", away);
    return () => document.removeEventListener("pointerdown", away);
  }, [open]);
  const onKeyDown = (event: KeyboardEvent): void => {
    if (!open) return;
    const items = [...(root.current?.querySelectorAll<HTMLElement>("[role=menuitem]") ?? [])];
    const at = items.indexOf(document.activeElement as HTMLElement);
    if (event.key === "Escape") setOpen(false);
    else if (event.key === "ArrowDown") items[(at + 1) % items.length]?.focus();
    else if (event.key === "ArrowUp") items[(at + items.length - 1) % items.length]?.focus();
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  return (
    <div class="menu" ref={root} onKeyDown={onKeyDown}>
      <button
        type="button"
        class={`button ${primary ? "primary" : ""}`}
        aria-haspopup="menu"
        aria-expanded={open}
        disabled={disabled ?? false}
        onClick={() => setOpen(!open)}
      >
        {icon && <Icon name={icon} />}
        <span>{label}</span>
        <Icon name="chevron" />
      </button>
      {open && (
        <div class="menu-list" role="menu" aria-label={label}>
          {children(() => setOpen(false))}
        </div>
      )}
    </div>
  );
}

interface MenuItemProps {
  label: string;
  detail?: string;
  disabled?: boolean;
  onClick: () => void;
}

export function MenuItem({ label, detail, disabled, onClick }: MenuItemProps) {
  return (
    <button type="button" role="menuitem" class="menu-item" disabled={disabled ?? false} onClick={onClick}>
      <span>{label}</span>
      {detail && <small>{detail}</small>}
    </button>
  );
}

export function Section({ title, children, action }: { title: string; children: ComponentChildren; action?: ComponentChildren }) {
  return (
    <section class="section">
      <header>
        <h2>{title}</h2>
        {action}
      </header>
      {children}
    </section>
  );
}
