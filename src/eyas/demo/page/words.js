// The page in other languages. What it says in English is the key, so that a text that nobody has
// translated is English; `{}` in a key stands for anything, which is translated in its turn.

import { CHINESE, TARGETS } from "./chinese.js";

const KEY = "eyas-language";
const ATTRIBUTES = ["title", "aria-label", "placeholder"];
const english = new WeakMap(); // what text nodes and elements say in English
const [texts, targets] = [CHINESE, TARGETS].map((words) => ({ words, rules: rulesOf(words) }));
let chinese = (stored() ?? navigator.language).startsWith("zh");

export function t(text, { words, rules } = texts) {
  if (!chinese) return text;
  const said = text.replace(/\s+/g, " ").trim();
  if (Object.hasOwn(words, said)) return words[said];
  for (const [rule, value] of rules) {
    const found = rule.exec(said);
    if (!found) continue;
    let at = 0;
    return value.replace(/\{(\d?)\}/g, (_, index) => t(found[1 + (index === "" ? at++ : Number(index))], { words, rules }));
  }
  return text;
}

// What a target is called: "a small green car".
export function named(target) {
  return t(target, targets);
}

function rulesOf(words) {
  return Object.entries(words).filter(([key]) => key.includes("{}")).map(([key, value]) => {
    const parts = key.split("{}").map((part) => part.replace(/[.*+?^$()|[\]\\]/g, "\\$&"));
    return [new RegExp(`^${parts.join("(.+?)")}$`), value];
  });
}

// Translates what the page's file says; what changes is said by `t`.
export function translatePage() {
  document.documentElement.lang = chinese ? "zh-CN" : "en";
  document.title = said(document, document.title);
  const nodes = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (nodes.nextNode()) {
    const node = nodes.currentNode;
    if (node.data.trim() && !node.parentElement.closest("kbd, #language")) node.data = said(node, node.data);
  }
  for (const name of ATTRIBUTES) {
    for (const element of document.querySelectorAll(`[${name}]:not(#language)`)) {
      const kept = english.get(element) ?? english.set(element, {}).get(element);
      element.setAttribute(name, t(kept[name] ??= element.getAttribute(name)));
    }
  }
  const button = document.getElementById("language");
  if (!button) return;
  button.textContent = button.ariaLabel = chinese ? "English" : "中文";
  button.lang = chinese ? "en" : "zh";
}

export function switchLanguage() {
  chinese = !chinese;
  try {
    localStorage.setItem(KEY, chinese ? "zh" : "en");
  } catch { /* it is not kept */ }
  translatePage();
}

function said(node, text) {
  if (!english.has(node)) english.set(node, text);
  return t(english.get(node));
}

function stored() {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null;
  }
}
