<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis version="3.22.16-Białowieża" styleCategories="Symbology|Labeling">
  <pipe-data-defined-properties>
    <Option type="Map">
      <Option value="" type="QString" name="name"/>
      <Option name="properties"/>
      <Option value="collection" type="QString" name="type"/>
    </Option>
  </pipe-data-defined-properties>
  <pipe>
    <provider>
      <resampling maxOversampling="2" enabled="false" zoomedInResamplingMethod="nearestNeighbour" zoomedOutResamplingMethod="nearestNeighbour"/>
    </provider>
    <rasterrenderer nodataColor="" type="singlebandpseudocolor" alphaBand="-1" band="1" opacity="0.85" classificationMax="0.00936162427773753" classificationMin="0">
      <minMaxOrigin>
        <limits>None</limits>
        <extent>WholeRaster</extent>
        <statAccuracy>Estimated</statAccuracy>
        <cumulativeCutLower>0.02</cumulativeCutLower>
        <cumulativeCutUpper>0.98</cumulativeCutUpper>
        <stdDevFactor>2</stdDevFactor>
      </minMaxOrigin>
      <rastershader>
        <colorrampshader maximumValue="0.0093616242777375264" minimumValue="0" labelPrecision="6" colorRampType="DISCRETE" classificationMode="1" clip="0">
          <item value="2.28555280218201e-06" label="below 1 % of the natural sky" alpha="0" color="#000000"/>
          <item value="4.57110560436403e-06" label="1 % – 2 %" alpha="255" color="#0d0887"/>
          <item value="9.14221120872805e-06" label="2 % – 4 %" alpha="255" color="#3a049b"/>
          <item value="1.82844224174561e-05" label="4 % – 8 %" alpha="255" color="#5d01a6"/>
          <item value="3.65688448349122e-05" label="8 % – 16 %" alpha="255" color="#7e03a8"/>
          <item value="7.31376896698244e-05" label="16 % – 32 %" alpha="255" color="#9c179e"/>
          <item value="0.000146275379339649" label="32 % – 64 %" alpha="255" color="#b52f8c"/>
          <item value="0.000292550758679298" label="64 % – 1.3 ×" alpha="255" color="#cb4778"/>
          <item value="0.000585101517358595" label="1.3 × – 2.6 ×" alpha="255" color="#dd6065"/>
          <item value="0.00117020303471719" label="2.6 × – 5.1 ×" alpha="255" color="#ed7953"/>
          <item value="0.00234040606943438" label="5.1 × – 10.2 ×" alpha="255" color="#f89541"/>
          <item value="0.00468081213886876" label="10.2 × – 20.5 ×" alpha="255" color="#feb32f"/>
          <item value="0.00936162427773753" label="20.5 × – 41 ×" alpha="255" color="#fbd524"/>
          <item value="inf" label="above 41 ×" alpha="255" color="#f0f921"/>
          <rampLegendSettings prefix="" maximumLabel="" suffix="" direction="0" minimumLabel="" orientation="2" useContinuousLegend="1">
            <numericFormat id="basic">
              <Option type="Map">
                <Option value="" type="QChar" name="decimal_separator"/>
                <Option value="6" type="int" name="decimals"/>
                <Option value="0" type="int" name="rounding_type"/>
                <Option value="false" type="bool" name="show_plus"/>
                <Option value="true" type="bool" name="show_thousand_separator"/>
                <Option value="false" type="bool" name="show_trailing_zeros"/>
                <Option value="" type="QChar" name="thousand_separator"/>
              </Option>
            </numericFormat>
          </rampLegendSettings>
        </colorrampshader>
      </rastershader>
    </rasterrenderer>
    <brightnesscontrast gamma="1" brightness="0" contrast="0"/>
    <huesaturation colorizeBlue="128" grayscaleMode="0" invertColors="0" colorizeStrength="100" colorizeRed="255" saturation="0" colorizeGreen="128" colorizeOn="0"/>
    <rasterresampler maxOversampling="2"/>
    <resamplingStage>resamplingFilter</resamplingStage>
  </pipe>
  <blendMode>0</blendMode>
</qgis>
