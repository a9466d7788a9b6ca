/** The controls that the panel is made of: each an element with its label, which a keyboard and a screen reader reach. */

let count = 0;

/** @param {string} name */
function newId(name) {
    count += 1;
    return `${name}-${count}`;
}

/**
 * @template {keyof HTMLElementTagNameMap} Name
 * @param {Name} name
 * @param {string} className
 * @param {string} [text]
 */
export function element(name, className, text = "") {
    const made = document.createElement(name);
    made.className = className;
    made.textContent = text;
    return made;
}

/**
 * Gives the keyboard back to flying once a control has been used with a pointer. Who uses the keyboard keeps the focus.
 * @param {HTMLElement} control
 * @param {"click" | "change"} isUsed The event after which it has been used.
 */
function giveBackKeyboard(control, isUsed) {
    let isByPointer = false;
    control.addEventListener("pointerdown", () => {
        isByPointer = true;
    });
    control.addEventListener("keydown", () => {
        isByPointer = false;
    });
    control.addEventListener(isUsed, () => {
        if (isByPointer) {
            control.blur();
        }
    });
}

/**
 * @param {string} text
 * @param {() => void} onPress
 */
export function button(text, onPress) {
    const made = element("button", "button", text);
    made.type = "button";
    giveBackKeyboard(made, "click");
    made.addEventListener("click", onPress);
    return made;
}

/**
 * A button that is down or up.
 * @param {string} text
 * @param {(isDown: boolean) => void} onChange
 */
export function toggle(text, onChange) {
    const made = button(text, () => onChange(made.getAttribute("aria-pressed") !== "true"));
    /** @param {boolean} isDown */
    const show = (isDown) => made.setAttribute("aria-pressed", String(isDown));
    show(false);
    return { field: made, show };
}

/**
 * One of several words.
 * @template {string} Value
 * @param {string} label
 * @param {Record<Value, string>} choices
 * @param {(value: Value) => void} onChange
 */
export function choice(label, choices, onChange) {
    const field = element("label", "field");
    const select = element("select", "select");
    select.id = newId("choice");
    for (const [value, text] of /** @type {[Value, string][]} */ (Object.entries(choices))) {
        select.append(new Option(text, value));
    }
    select.addEventListener("change", () => onChange(/** @type {Value} */ (select.value)));
    giveBackKeyboard(select, "change");
    field.append(element("span", "label", label), select);
    /** @param {Value} value */
    const show = (value) => {
        select.value = value;
    };
    return { field, show };
}

/**
 * A number on a line.
 * @param {string} label
 * @param {{ from: number, to: number, step: number }} range
 * @param {(value: number) => string} words How a value is written beside the line.
 * @param {(value: number) => void} onChange
 */
export function slider(label, { from, to, step }, words, onChange) {
    const field = element("label", "field");
    const line = element("input", "slider");
    const written = element("output", "value");
    Object.assign(line, { type: "range", min: String(from), max: String(to), step: String(step) });
    line.addEventListener("input", () => onChange(line.valueAsNumber));
    giveBackKeyboard(line, "change");
    field.append(element("span", "label", label), line, written);
    /** @param {number} value */
    const show = (value) => {
        if (line.valueAsNumber !== value) {
            line.value = String(value);
        }
        const text = words(value);
        if (written.textContent !== text) {
            written.textContent = text;
            line.setAttribute("aria-valuetext", text);
        }
    };
    return { field, show, line };
}

/**
 * Several controls under a heading.
 * @param {string} title
 * @param {HTMLElement[]} fields
 */
export function group(title, fields) {
    const made = element("fieldset", "group");
    made.append(element("legend", "legend", title), ...fields);
    return made;
}
